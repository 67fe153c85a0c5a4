// What meshes bring along for voxels to carry.
#ifndef LATVOX_CLIENT_MESH_MESH_ATTRIBUTES_H_
#define LATVOX_CLIENT_MESH_MESH_ATTRIBUTES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "client/mesh/mesh.h"
#include "latvox/types.h"

namespace latvox::client {

// The triangles that are added from now on belong together. `part` is not below that of the stretch before.
void BeginStretch(uint32_t part, std::optional<uint32_t> material, Mesh& mesh);

// The part to give to a further object: the one after the last that has triangles.
uint32_t NextPart(const Mesh& mesh);

// Red, green and blue as bytes, from numbers between 0 and 1; beyond these there are no colors.
Color ToColor(const float* rgb);

// Gives the mesh colors, those of each triangle's corners. A vertex with several becomes several in one place.
void ColorCorners(const std::vector<std::array<Color, 3>>& colors, Mesh& mesh);

// INVALID_ARGUMENT naming the first of the attributes that some of the mesh lacks, and why if its file has colors
// that are not read.
absl::Status CheckHas(const std::vector<Attribute>& attributes, const Mesh& mesh);

// The numbers of a mesh that has them, as Attribute has them.
class AttributeNumbers {
 public:
  explicit AttributeNumbers(const Mesh& mesh) : mesh_(mesh) {}

  // Of a triangle, not before the one asked for last, at one of its vertices.
  uint32_t At(size_t triangle, uint32_t vertex, Attribute attribute);

 private:
  const Mesh& mesh_;
  size_t next_ = 0;  // of the stretches: the first that is not at or before the triangle
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_MESH_ATTRIBUTES_H_
