#include "latvox/mesh/encode_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh/mesh_encoder.h"
#include "client/mesh/raw_mesh.h"

namespace latvox::client {
namespace {

template <class... Parts>
absl::Status Wrong(const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat(parts...));
}

absl::Status CheckBits(int quantization_bits) {
  if (quantization_bits >= 0 && quantization_bits <= kMaxQuantizationBits) return absl::OkStatus();
  return Wrong("quantization_bits: ", quantization_bits, " is not within 0 to ", kMaxQuantizationBits);
}

// Copies positions that float32 can hold.
template <class Number>
absl::Status CopyPositions(std::span<const std::array<Number, 3>> from, Mesh& mesh) {
  mesh.positions.reserve(from.size());
  for (size_t p = 0; p < from.size(); ++p) {
    Vec3d& position = mesh.positions.emplace_back();
    for (size_t m = 0; m < 3; ++m) {
      const double x = position[m] = from[p][m];
      if (!std::isfinite(x)) return Wrong("positions[", p, "]: ", x, " is not finite");
      if (!std::isfinite(static_cast<float>(x))) return Wrong("positions[", p, "]: ", x, " exceeds float32");
    }
  }
  return absl::OkStatus();
}

absl::Status CopyTriangles(std::span<const std::array<uint32_t, 3>> from, Mesh& mesh) {
  for (size_t t = 0; t < from.size(); ++t) {
    for (const uint32_t vertex : from[t]) {
      if (vertex < mesh.positions.size()) continue;
      return Wrong("triangles[", t, "]: index ", vertex, " is not below ", mesh.positions.size(), ", the positions");
    }
  }
  mesh.triangles.assign(from.begin(), from.end());
  return absl::OkStatus();
}

// `values` is empty, or has one value for each of `count` `owners`.
template <class Value>
absl::Status CheckCount(const char* name, const std::vector<Value>& values, size_t count, const char* owners) {
  if (values.empty() || values.size() == count) return absl::OkStatus();
  return Wrong(name, ": ", values.size(), " values for ", count, " ", owners);
}

absl::Status CopyAttributes(const TriangleMesh& from, Mesh& mesh) {
  const size_t triangles = from.triangles.size();
  if (absl::Status status = CheckCount("parts", from.parts, triangles, "triangles"); !status.ok()) return status;
  if (absl::Status status = CheckCount("materials", from.materials, triangles, "triangles"); !status.ok())
    return status;
  if (absl::Status status = CheckCount("colors", from.colors, from.positions.size(), "positions"); !status.ok()) {
    return status;
  }
  mesh.colors = from.colors;
  for (size_t t = 0; t < triangles; ++t) {
    Stretch stretch{.first = t};
    if (!from.parts.empty()) stretch.part = from.parts[t];
    if (!from.materials.empty()) stretch.material = from.materials[t];
    const uint32_t before = mesh.stretches.empty() ? 0 : mesh.stretches.back().part;
    if (stretch.part < before)
      return Wrong("parts[", t, "]: ", stretch.part, " is below ", before, ", the part before");
    const bool begins = mesh.stretches.empty() || mesh.stretches.back().part != stretch.part ||
                        mesh.stretches.back().material != stretch.material;
    if (begins) mesh.stretches.push_back(stretch);
  }
  return absl::OkStatus();
}

absl::Status CheckAttributes(const std::vector<Field>& attributes, const Mesh& mesh) {
  for (auto attribute = attributes.begin(); attribute != attributes.end(); ++attribute) {
    if (std::find(attributes.begin(), attribute, *attribute) != attribute) {
      return Wrong("fields: ", NameOf(*attribute), " is named twice");
    }
  }
  return CheckHas(attributes, mesh);
}

absl::StatusOr<std::string> BytesOf(absl::StatusOr<EncodedMesh> encoded) {
  if (!encoded.ok()) return encoded.status();
  return std::move(encoded->drc);
}

}  // namespace

absl::StatusOr<std::string> EncodeMesh(std::span<const std::array<float, 3>> positions,
                                       std::span<const std::array<uint32_t, 3>> triangles, int quantization_bits) {
  if (absl::Status status = CheckBits(quantization_bits); !status.ok()) return status;
  Mesh mesh;
  if (absl::Status status = CopyPositions(positions, mesh); !status.ok()) return status;
  if (absl::Status status = CopyTriangles(triangles, mesh); !status.ok()) return status;
  return BytesOf(EncodeMesh(mesh, quantization_bits));
}

absl::StatusOr<RawMesh> EncodeRawMesh(const TriangleMesh& mesh, const std::vector<Field>& attributes) {
  Mesh copy;
  for (size_t p = 0; p < mesh.positions.size(); ++p) {
    for (const double x : mesh.positions[p]) {
      if (!std::isfinite(x)) return Wrong("positions[", p, "]: ", x, " is not finite");
    }
  }
  copy.positions = mesh.positions;
  if (mesh.triangles.empty()) return Wrong("the mesh has no triangles");
  if (absl::Status status = CopyTriangles(mesh.triangles, copy); !status.ok()) return status;
  if (absl::Status status = CopyAttributes(mesh, copy); !status.ok()) return status;
  if (absl::Status status = CheckAttributes(attributes, copy); !status.ok()) return status;
  return ToRaw(copy, attributes);
}

absl::StatusOr<std::string> EncodeMesh(const TriangleMesh& mesh, const EncodeOptions& options) {
  if (absl::Status status = CheckBits(options.quantization_bits); !status.ok()) return status;
  Mesh copy;
  if (absl::Status status = CopyPositions<double>(mesh.positions, copy); !status.ok()) return status;
  if (absl::Status status = CopyTriangles(mesh.triangles, copy); !status.ok()) return status;
  if (absl::Status status = CopyAttributes(mesh, copy); !status.ok()) return status;
  if (absl::Status status = CheckAttributes(options.fields, copy); !status.ok()) return status;
  return BytesOf(EncodeMesh(copy, options.quantization_bits, options.fields));
}

}  // namespace latvox::client
