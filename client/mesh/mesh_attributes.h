// The attributes of meshes, for voxels to carry.
#ifndef LATVOX_CLIENT_MESH_MESH_ATTRIBUTES_H_
#define LATVOX_CLIENT_MESH_MESH_ATTRIBUTES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"
#include "latvox/types.h"

namespace latvox::client {

// Begins a stretch: the triangles added from now on belong together. `part` is not below that of the stretch before.
void BeginStretch(uint32_t part, std::optional<uint32_t> material, Mesh& mesh);

// Returns the part for a further object: the number after the last one with triangles.
uint32_t NextPart(const Mesh& mesh);

// Converts red, green and blue from numbers between 0 and 1 to bytes; other numbers are clamped.
Color ToColor(const float* rgb);

// Gives the mesh the colors of its triangles' corners. A vertex with several colors becomes several vertices at one
// place.
void ColorCorners(const std::vector<std::array<Color, 3>>& colors, Mesh& mesh);

// Names a part or material; "": unknown. Bytes that are not UTF-8 become U+FFFD, because most formats of results hold
// text alone.
void SetName(uint32_t number, absl::string_view name, std::vector<std::string>& names);

// Returns INVALID_ARGUMENT naming the first attribute that some of the mesh lacks, with the reason if its file has
// colors that are not read.
absl::Status CheckHas(const std::vector<Field>& attributes, const Mesh& mesh);

// The numbers of a mesh with these attributes, in the form of the protocol's Field.
class AttributeNumbers {
 public:
  explicit AttributeNumbers(const Mesh& mesh) : mesh_(mesh) {}

  // Returns the number of a triangle at one of its vertices. Triangles must not descend from call to call.
  uint32_t At(size_t triangle, uint32_t vertex, Field attribute);

 private:
  const Mesh& mesh_;
  size_t next_ = 0;  // the first of the stretches that is not at or before the triangle
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_MESH_ATTRIBUTES_H_
