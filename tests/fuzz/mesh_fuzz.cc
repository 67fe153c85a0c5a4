// Foreign meshes. Every input gives a clean status, or finite positions and triangles between them.
#include <zip.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "client/mesh_files/gltf_file.h"
#include "client/mesh_files/gltf_meshopt.h"
#include "client/mesh_files/mesh_format.h"
#include "client/mesh_files/obj_file.h"
#include "client/mesh_files/off_file.h"
#include "client/mesh_files/ply_file.h"
#include "client/mesh_files/stl_file.h"
#include "client/mesh_files/three_mf_file.h"

namespace {

constexpr absl::string_view kRelations =
    R"(<Relationships><Relationship Target="/m" Type="/3dmodel"/></Relationships>)";

void Check(const absl::StatusOr<latvox::client::Mesh>& mesh) {
  if (!mesh.ok()) return;
  for (const auto& [x, y, z] : mesh->positions) {
    if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(z)) std::abort();
  }
  if (mesh->colors.size() > mesh->positions.size()) std::abort();
  const latvox::client::BaseColors& base = mesh->base_colors;
  if (std::max(base.triangles.size(), base.vertices.size()) > mesh->triangles.size()) std::abort();
  for (const latvox::client::TriangleBaseColor& triangle : base.triangles) {
    if (triangle.number != triangle.kNone && triangle.number >= base.all.size()) std::abort();
  }
  for (const auto& triangle : mesh->triangles) {
    for (const uint32_t vertex : triangle) {
      if (vertex >= mesh->positions.size()) std::abort();
    }
  }
}

void Add(zip_t* archive, const char* name, absl::string_view bytes) {
  zip_source_t* source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
  const zip_int64_t index = zip_file_add(archive, name, source, 0);
  if (index < 0 || zip_set_file_compression(archive, static_cast<zip_uint64_t>(index), ZIP_CM_STORE, 0) < 0)
    std::abort();
}

// A 3MF file with the model.
std::string Archive(absl::string_view model) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* memory = zip_source_buffer_create(nullptr, 0, 0, &error);
  zip_source_keep(memory);
  zip_t* archive = zip_open_from_source(memory, ZIP_TRUNCATE, &error);
  if (archive == nullptr) std::abort();
  Add(archive, "_rels/.rels", kRelations);
  Add(archive, "m", model);
  if (zip_close(archive) < 0 || zip_source_open(memory) < 0) std::abort();
  zip_source_seek(memory, 0, SEEK_END);
  std::string bytes(static_cast<size_t>(zip_source_tell(memory)), '\0');
  zip_source_seek(memory, 0, SEEK_SET);
  if (zip_source_read(memory, bytes.data(), bytes.size()) != static_cast<zip_int64_t>(bytes.size())) std::abort();
  zip_source_close(memory);
  zip_source_free(memory);
  zip_error_fini(&error);
  return bytes;
}

// The bytes as a stream of a glTF file, whose fields the first bytes choose.
void CheckStream(absl::string_view bytes) {
  constexpr size_t kFields = 5;
  constexpr const char* kModes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
  constexpr const char* kFilters[] = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
  if (bytes.size() < kFields) return;
  const auto field = [&](size_t n) { return static_cast<uint8_t>(bytes[n]); };
  const uint64_t count = field(2) + 256 * field(3), stride = field(4);
  const auto decoded = latvox::client::DecodeGltfMeshopt(
      {{"mode", kModes[field(0) % 3]}, {"filter", kFilters[field(1) % 4]}, {"count", count}, {"byteStride", stride}},
      {{"byteLength", count * stride}}, bytes.substr(kFields), 1 << 24);
  if (decoded.ok() && decoded->size() != count * stride) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const absl::string_view bytes(reinterpret_cast<const char*>(data), size);
  latvox::client::FormatOfBytes(bytes);
  CheckStream(bytes);
  const std::string archive = Archive(bytes);
  for (const bool skip_bad : {false, true}) {
    const latvox::client::ParseOptions options{skip_bad, /*base_colors=*/true};
    Check(latvox::client::ParseObj(bytes, options));
    Check(latvox::client::ParseOff(bytes, options));
    Check(latvox::client::ParsePly(bytes, options));
    Check(latvox::client::ParseStl(bytes, options));
    Check(latvox::client::Parse3mf(bytes, options));
    Check(latvox::client::Parse3mf(archive, options));
    Check(latvox::client::ParseGltf(bytes, "/nowhere", options));
  }
  return 0;
}
