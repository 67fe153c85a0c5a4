#include "server/wire/convert.h"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "absl/strings/str_cat.h"
#include "server/wire/enums.h"
#include "server/wire/vectors.h"

namespace latvox {
namespace {

// The names in this request of fields that core reports later.
RequestFields FieldNamesOf(const v1::VoxelizeSpec& spec) {
  RequestFields names;
  if (spec.has_voxel_size()) names.sampling = "voxel_size";
  if (spec.has_resolution()) names.sampling = "resolution";
  if (spec.has_band()) names.band = spec.band().has_voxels() ? "band.voxels" : "band.width";
  return names;
}

absl::StatusOr<std::variant<NamedLattice, Mat3d>> LatticeFromProto(const v1::Lattice& lattice) {
  switch (lattice.kind_case()) {
    case v1::Lattice::kNamed:
      return Meaning(kLatticeNumbers, lattice.named(), "lattice.named", "a lattice");
    case v1::Lattice::kBasis: {
      const v1::Basis& basis = lattice.basis();
      return Mat3d{FromProto(basis.a()), FromProto(basis.b()), FromProto(basis.c())};
    }
    case v1::Lattice::KIND_NOT_SET:
      break;
  }
  return BadSpec("lattice: neither named nor basis is set", "lattice", "");
}

absl::StatusOr<GridRequest> GridFromProto(const v1::VoxelizeSpec& spec) {
  auto lattice = LatticeFromProto(spec.lattice());
  if (!lattice.ok()) return lattice.status();
  GridOptions grid{*std::move(lattice), {}, std::nullopt};
  if (spec.has_voxel_size()) grid.sampling.voxel_size = spec.voxel_size();
  if (spec.has_resolution()) grid.sampling.resolution = spec.resolution();
  if (spec.has_origin()) grid.origin = FromProto(spec.origin());
  auto request = MakeGridRequest(grid);
  return request.ok() ? std::move(request) : WithCauseOfCore(request.status(), FieldNamesOf(spec));
}

// Writes the labels of a set, and their priority. Errors: INVALID_ARGUMENT, naming the set's field.
template <class Message, class Set>
absl::Status LabelsFromProto(const Message& message, const char* field, Set& set) {
  set.priority.assign(message.priority().begin(), message.priority().end());
  if (message.labels() == v1::FIELD_UNSPECIFIED) return absl::OkStatus();
  const absl::StatusOr<Field> labels = Meaning(kFieldNumbers, message.labels(), field, "a field");
  if (!labels.ok()) return labels.status();
  set.labels = *labels;
  return absl::OkStatus();
}

absl::StatusOr<SetOption> SolidFromProto(const v1::Solid& solid) {
  const absl::StatusOr<InteriorRule> rule = Meaning(kInteriorRuleNumbers, solid.rule(), "solid.rule", "a rule");
  if (!rule.ok()) return rule.status();
  const absl::StatusOr<SolidSurface> surface =
      Meaning(kSolidSurfaceNumbers, solid.surface(), "solid.surface", "a surface");
  if (!surface.ok()) return surface.status();
  Solid out{.rule = *rule, .surface = *surface, .force_open = solid.force_open()};
  if (absl::Status status = LabelsFromProto(solid, "solid.labels", out); !status.ok()) return status;
  return out;
}

absl::StatusOr<Bounds> BoundsFromProto(const v1::WorldBox& box) {
  if (box.has_min() && box.has_max()) return Bounds{FromProto(box.min()), FromProto(box.max())};
  const std::string field = box.has_min() ? "bounds.max" : "bounds.min";
  return BadSpec(absl::StrCat(field, " is not set"), field, "");
}

absl::StatusOr<SetOption> BandFromProto(const v1::Band& band) {
  if (band.has_voxels()) return Band{band.voxels(), true};
  if (band.has_width()) return Band{band.width(), false};
  return BadSpec("band: neither width nor voxels is set", "band", "");
}

absl::StatusOr<SetOption> LinksFromProto(const v1::Links& links) {
  const absl::StatusOr<LinkSide> side = Meaning(kLinkSideNumbers, links.side(), "links.side", "a side");
  if (!side.ok()) return side.status();
  return Links{*side};
}

absl::StatusOr<SetOption> EnclosedFromProto(const v1::Enclosed& enclosed) {
  const absl::StatusOr<SolidSurface> surface =
      Meaning(kSolidSurfaceNumbers, enclosed.surface(), "enclosed.surface", "a surface");
  if (!surface.ok()) return surface.status();
  Enclosed set{.surface = *surface, .close = enclosed.close()};
  if (enclosed.has_leak_from()) set.leak_from = FromProto(enclosed.leak_from());
  if (absl::Status status = LabelsFromProto(enclosed, "enclosed.labels", set); !status.ok()) return status;
  return set;
}

absl::StatusOr<SetOption> ConnectedFromProto(const v1::Connected& connected) {
  if (!connected.has_seed()) return BadSpec("connected.seed is not set", "connected.seed", "");
  return Connected{FromProto(connected.seed()), connected.close(), connected.allow_outside()};
}

absl::StatusOr<SetOption> SetFromProto(const v1::VoxelizeSpec& spec) {
  switch (spec.set_case()) {
    case v1::VoxelizeSpec::kSupercover:
      return SupercoverSurface{};
    case v1::VoxelizeSpec::kSolid:
      return SolidFromProto(spec.solid());
    case v1::VoxelizeSpec::kBand:
      return BandFromProto(spec.band());
    case v1::VoxelizeSpec::kLinks:
      return LinksFromProto(spec.links());
    case v1::VoxelizeSpec::kEnclosed:
      return EnclosedFromProto(spec.enclosed());
    case v1::VoxelizeSpec::kConnected:
      return ConnectedFromProto(spec.connected());
    case v1::VoxelizeSpec::kSurface:
    case v1::VoxelizeSpec::SET_NOT_SET:
      break;
  }
  return SeparatingSurface{};
}

//   name_of_list   in the request
absl::StatusOr<FieldList> FieldsFromProto(const google::protobuf::RepeatedField<int>& numbers,
                                          const char* name_of_list) {
  FieldList fields;
  for (const int number : numbers) {
    const absl::StatusOr<Field> field = Meaning(kFieldNumbers, number, name_of_list, "a field");
    if (!field.ok()) return field.status();
    const std::string name{NameOf(*field)};
    if (fields.Contains(*field)) {
      return BadSpec(absl::StrCat(name_of_list, ": ", name, " stands twice"), name_of_list, name);
    }
    fields.Add(*field);
  }
  return fields;
}

absl::StatusOr<FieldList> MeshFieldsFromProto(const v1::RawMesh& raw) {
  auto fields = FieldsFromProto(raw.fields(), "raw_mesh.fields");
  if (!fields.ok() || fields->OfMesh() == *fields) return fields;
  const auto other = std::ranges::find_if(*fields, [](Field field) { return !FactsOf(field).is_of_mesh(); });
  const std::string name{NameOf(*other)};
  return BadSpec(absl::StrCat("raw_mesh.fields: a mesh has no ", name, " for its vertices"), "raw_mesh.fields", name);
}

// Where spec has a field, sets `out` to its meaning.
template <class T, class U>
absl::Status Assign(absl::StatusOr<T> value, U& out) {
  if (value.ok()) out = *std::move(value);
  return value.status();
}

absl::StatusOr<VoxelRequest> RequestFromProto(const v1::VoxelizeSpec& spec) {
  VoxelizeOptions options;
  options.separability = spec.separability();
  if (spec.has_minimal()) options.minimal = spec.minimal();
  if (spec.has_region()) options.region = {FromProto(spec.region().min()), FromProto(spec.region().max())};
  if (spec.has_shard()) options.shard = {spec.shard().index(), spec.shard().count()};
  if (spec.has_resume_after()) options.resume_after = FromProto(spec.resume_after());
  options.verify = spec.verify();
  absl::Status status =
      Assign(Meaning(kAlgorithmNumbers, spec.algorithm(), "algorithm", "an algorithm"), options.algorithm);
  if (spec.has_bounds()) status.Update(Assign(BoundsFromProto(spec.bounds()), options.bounds));
  status.Update(Assign(SetFromProto(spec), options.set));
  status.Update(Assign(FieldsFromProto(spec.fields(), "fields"), options.fields));
  options.signed_distance = spec.signed_distance();
  status.Update(
      Assign(Meaning(kInteriorRuleNumbers, spec.interior_rule(), "interior_rule", "a rule"), options.interior_rule));
  options.fraction_n = spec.fraction_n();
  options.fraction_labels.assign(spec.fraction_labels().begin(), spec.fraction_labels().end());
  if (!status.ok()) return status;
  auto request = MakeRequest(options);
  return request.ok() ? std::move(request) : WithCauseOfCore(request.status());
}

}  // namespace

absl::StatusOr<RawMeshLayout> RawMeshFromProto(const v1::RawMesh& raw, const Limits& limits) {
  if (raw.triangles() == 0) return BadSpec("raw_mesh.triangles 0 is below 1", "raw_mesh.triangles", "0", "1");
  if (raw.vertices() > limits.max_vertices) return LimitExceeded("mesh.vertices", raw.vertices(), limits.max_vertices);
  if (raw.triangles() > limits.max_triangles) {
    return LimitExceeded("mesh.triangles", raw.triangles(), limits.max_triangles);
  }
  const auto doubles = Meaning(kPositionTypeNumbers, raw.positions(), "raw_mesh.positions", "a type of numbers");
  if (!doubles.ok()) return doubles.status();
  const auto fields = MeshFieldsFromProto(raw);
  if (!fields.ok()) return fields.status();
  const RawMeshLayout layout{raw.vertices(), raw.triangles(), *doubles, *fields};
  if (layout.bytes() > limits.max_mesh_bytes) {
    return LimitExceeded("mesh_bytes", layout.bytes(), limits.max_mesh_bytes);
  }
  return layout;
}

absl::StatusOr<MeshSpec> MeshSpecFromProto(const v1::PutMeshSpec& spec, const Limits& limits, uint64_t store_capacity) {
  const absl::StatusOr<MeshDigest> digest = MeshDigestFrom(spec.mesh_sha256());
  if (!digest.ok()) return digest.status();
  MeshSpec mesh{*digest, spec.mesh_bytes()};
  if (mesh.bytes == 0) return BadSpec("mesh_bytes 0 is below 1", "mesh_bytes", "0", "1");
  if (mesh.bytes > limits.max_mesh_bytes) return LimitExceeded("mesh_bytes", mesh.bytes, limits.max_mesh_bytes);
  if (mesh.bytes > store_capacity) {
    return LimitExceeded("mesh_bytes", mesh.bytes, store_capacity, "mesh_store_bytes");
  }
  if (spec.has_raw_mesh()) {
    const absl::StatusOr<RawMeshLayout> layout = RawMeshFromProto(spec.raw_mesh(), limits);
    if (!layout.ok()) return layout.status();
    mesh.raw = *layout;
  }
  return mesh;
}

absl::StatusOr<JobSpec> JobSpecFromProto(const v1::VoxelizeSpec& spec, const Limits& limits) {
  if (spec.mesh_bytes() > limits.max_mesh_bytes) {
    return LimitExceeded("mesh_bytes", spec.mesh_bytes(), limits.max_mesh_bytes);
  }
  absl::StatusOr<GridRequest> grid = GridFromProto(spec);
  if (!grid.ok()) return grid.status();
  absl::StatusOr<VoxelRequest> request = RequestFromProto(spec);
  if (!request.ok()) return request.status();
  const auto encoding = Meaning(kEncodingNumbers, spec.encoding(), "encoding", "an encoding");
  if (!encoding.ok()) return encoding.status();
  const auto placement = Meaning(kPlacementNumbers, spec.placement(), "placement", "a placement");
  if (!placement.ok()) return placement.status();
  JobSpec job{*std::move(grid),    PlacementFor(*placement, request->is_filled()),
              *std::move(request), *encoding,
              spec.mesh_bytes(),   std::nullopt,
              FieldNamesOf(spec)};
  if (!spec.mesh_sha256().empty()) {
    const absl::StatusOr<MeshDigest> digest = MeshDigestFrom(spec.mesh_sha256());
    if (!digest.ok()) return digest.status();
    job.mesh_digest = *digest;
  }
  if (spec.has_raw_mesh()) {
    const absl::StatusOr<RawMeshLayout> layout = RawMeshFromProto(spec.raw_mesh(), limits);
    if (!layout.ok()) return layout.status();
    if (job.mesh_bytes != 0 && job.mesh_bytes != layout->bytes()) {
      return BadSpec(
          absl::StrCat("mesh_bytes ", job.mesh_bytes, " is not ", layout->bytes(), ", as raw_mesh describes"),
          "mesh_bytes", absl::StrCat(job.mesh_bytes), absl::StrCat(layout->bytes()));
    }
    job.mesh_bytes = layout->bytes();
    job.raw_mesh = *layout;
  }
  return job;
}

}  // namespace latvox
