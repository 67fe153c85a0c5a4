#include "tests/faults/good_scripts.h"

#include <openssl/sha.h>

#include <algorithm>

#include "latvox/v1/voxelizer.pb.h"

namespace latvox::faults {
namespace {

std::string Method(const std::string& name) { return "/latvox.v1.Voxelizer/" + name; }

std::string Sha256(const std::string& bytes) {
  std::string digest(SHA256_DIGEST_LENGTH, '\0');
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(),
         reinterpret_cast<unsigned char*>(digest.data()));
  return digest;
}

template <class Request>
void AppendPieces(const std::string& drc, Chance& chance, Script& script) {
  const size_t piece = 1 + chance.Below(drc.size());
  for (size_t begin = 0; begin < drc.size(); begin += std::max<size_t>(piece, drc.size() / 8)) {
    Request message;
    message.set_mesh_piece(drc.substr(begin, std::max<size_t>(piece, drc.size() / 8)));
    script.messages.push_back(message.SerializeAsString());
  }
}

v1::VoxelizeSpec AnySpec(const std::string& drc, Chance& chance) {
  v1::VoxelizeSpec spec;
  spec.mutable_lattice()->set_named(static_cast<v1::NamedLattice>(1 + chance.Below(v1::NamedLattice_MAX)));
  spec.set_resolution(static_cast<uint32_t>(16 + chance.Below(48)));
  spec.set_separability(static_cast<uint32_t>(chance.Below(3)));
  spec.set_verify(chance.OneIn(8));
  if (chance.OneIn(2)) spec.set_mesh_bytes(drc.size());
  if (chance.OneIn(3)) spec.set_mesh_sha256(Sha256(drc));
  if (chance.OneIn(8)) spec.set_algorithm(static_cast<v1::Algorithm>(chance.Below(5)));
  if (chance.OneIn(8)) spec.mutable_resume_after()->set_i(0);
  if (chance.OneIn(8) && !spec.verify()) {
    for (auto set : {&v1::Ijk::set_i, &v1::Ijk::set_j, &v1::Ijk::set_k})
      (spec.mutable_region()->mutable_max()->*set)(20);
  }
  return spec;
}

Script Voxelize(const std::string& drc, Chance& chance) {
  Script script;
  script.method = Method("Voxelize");
  v1::VoxelizeRequest request;
  *request.mutable_spec() = AnySpec(drc, chance);
  script.messages.push_back(request.SerializeAsString());
  AppendPieces<v1::VoxelizeRequest>(drc, chance, script);
  return script;
}

Script PutMesh(const std::string& drc, Chance& chance) {
  Script script;
  script.method = Method("PutMesh");
  v1::PutMeshRequest request;
  request.mutable_spec()->set_mesh_sha256(Sha256(drc));
  request.mutable_spec()->set_mesh_bytes(drc.size());
  script.messages.push_back(request.SerializeAsString());
  AppendPieces<v1::PutMeshRequest>(drc, chance, script);
  return script;
}

// A call with one message from the client. The upload or the mesh that it goes on with may not be there.
Script OneMessage(const std::string& drc, Chance& chance) {
  Script script;
  if (chance.OneIn(3)) {
    script.method = Method("UploadMesh");
    v1::UploadMeshRequest request;
    request.mutable_spec()->set_mesh_sha256(Sha256(drc));
    request.mutable_spec()->set_mesh_bytes(drc.size());
    request.set_offset(chance.OneIn(2) ? 0 : chance.Below(drc.size()));
    request.set_mesh_piece(drc.substr(request.offset(), 1 + chance.Below(drc.size())));
    script.messages.push_back(request.SerializeAsString());
  } else if (chance.OneIn(2)) {
    script.method = Method("VoxelizeStored");
    v1::VoxelizeStoredRequest request;
    *request.mutable_spec() = AnySpec(drc, chance);
    request.mutable_spec()->set_mesh_sha256(Sha256(drc));
    script.messages.push_back(request.SerializeAsString());
  } else {
    script.method = Method("VoxelizeSmall");
    v1::VoxelizeSmallRequest request;
    *request.mutable_spec() = AnySpec(drc, chance);
    request.set_mesh(drc);
    script.messages.push_back(request.SerializeAsString());
  }
  return script;
}

Script Pixelize(Chance& chance) {
  Script script;
  script.method = Method("Pixelize");
  v1::PixelizeRequest request;
  for (uint64_t lines = 1 + chance.Below(3); lines > 0; --lines) {
    v1::Polyline& line = *request.add_polylines();
    for (uint64_t n = 2 * (1 + chance.Below(10)); n > 0; --n) line.add_xy(chance.Between(-1, 1));
    line.set_closed(chance.OneIn(2));
  }
  request.mutable_lattice()->set_named(static_cast<v1::NamedPlaneLattice>(1 + chance.Below(v1::NamedPlaneLattice_MAX)));
  request.set_resolution(static_cast<uint32_t>(2 + chance.Below(200)));
  request.set_separability(static_cast<uint32_t>(chance.Below(2)));
  script.messages.push_back(request.SerializeAsString());
  return script;
}

Script GetLimits() {
  Script script;
  script.method = Method("GetLimits");
  script.messages.emplace_back();
  return script;
}

}  // namespace

Script GoodScript(const std::string& drc, Chance& chance) {
  switch (chance.Below(10)) {
    case 0:
      return GetLimits();
    case 1:
      return PutMesh(drc, chance);
    case 2:
      return Pixelize(chance);
    case 3:
    case 4:
      return OneMessage(drc, chance);
    default:
      return Voxelize(drc, chance);
  }
}

}  // namespace latvox::faults
