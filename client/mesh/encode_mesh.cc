#include "latvox/mesh/encode_mesh.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/mesh/mesh_encoder.h"

namespace latvox::client {

absl::StatusOr<std::string> EncodeMesh(std::span<const std::array<float, 3>> positions,
                                       std::span<const std::array<uint32_t, 3>> triangles, int quantization_bits) {
  if (quantization_bits < 0 || quantization_bits > kMaxQuantizationBits) {
    return absl::InvalidArgumentError(
        absl::StrCat("quantization_bits: ", quantization_bits, " is not within 0 to ", kMaxQuantizationBits));
  }
  for (size_t p = 0; p < positions.size(); ++p) {
    for (const float x : positions[p]) {
      if (!std::isfinite(x))
        return absl::InvalidArgumentError(absl::StrCat("positions[", p, "]: ", x, " is not finite"));
    }
  }
  for (size_t t = 0; t < triangles.size(); ++t) {
    for (const uint32_t vertex : triangles[t]) {
      if (vertex < positions.size()) continue;
      return absl::InvalidArgumentError(
          absl::StrCat("triangles[", t, "]: index ", vertex, " is not below ", positions.size(), ", the positions"));
    }
  }
  Mesh mesh;
  mesh.positions.assign(positions.begin(), positions.end());
  mesh.triangles.assign(triangles.begin(), triangles.end());
  absl::StatusOr<EncodedMesh> encoded = EncodeMesh(mesh, quantization_bits);
  if (!encoded.ok()) return encoded.status();
  return std::move(encoded->drc);
}

}  // namespace latvox::client
