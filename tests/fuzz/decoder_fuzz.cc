// Foreign bytes to a mesh. Every input gives a clean status, or a mesh that core accepts.
#include <cstdint>
#include <cstdlib>

#include "server/decode/draco_decoder.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  latvox::Limits limits;
  limits.max_triangles = 10000;
  limits.max_vertices = 10000;
  const absl::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto decoded = latvox::DecodeDraco(bytes, limits);
  if (decoded.ok() && !latvox::CheckMesh(decoded->mesh).ok()) std::abort();
  for (const auto attribute : {latvox::Field::kPart, latvox::Field::kColor}) {
    const auto carrying = latvox::DecodeDraco(bytes, limits, {attribute});
    if (carrying.ok() && carrying->mesh.attributes.size() != decoded->mesh.vertices.size()) std::abort();
  }
  return 0;
}
