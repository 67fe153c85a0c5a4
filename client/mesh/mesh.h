// A triangle mesh as the client reads and encodes it.
#ifndef LATVOX_CLIENT_MESH_MESH_H_
#define LATVOX_CLIENT_MESH_MESH_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace latvox::client {

using Vec3f = std::array<float, 3>;

using Color = std::array<uint8_t, 3>;  // red, green, blue

// Triangles that follow each other, up to the first of the next stretch.
struct Stretch {
  size_t first = 0;                                 // triangle
  uint32_t part = 0;                                // of the objects of a scene, and of several meshes
  std::optional<uint32_t> material = std::nullopt;  // below Mesh::materials
};

// Triangles index positions. Degenerate and duplicate triangles are kept: the mesh is what the file says.
struct Mesh {
  std::vector<Vec3f> positions;                    // world, finite
  std::vector<std::array<uint32_t, 3>> triangles;  // each index < positions.size()
  uint64_t skipped = 0;                            // points and lines of the file; they have no surface
  std::vector<Stretch> stretches = {};     // in order, parts ascending; none: all are part 0, without a material
  uint32_t materials = 0;                  // that stretches name
  std::vector<Color> colors = {};          // of each position; of fewer: some have none
  std::vector<std::string> warnings = {};  // what of the file is not read as it may have been meant
  std::string no_color = {};               // why some of the file's colors are not among these; empty: it has no others
};

// Of scenes, which may place a mesh of theirs many times: triangles, and vertices, in all.
inline constexpr size_t kMostPlaced = size_t{1} << 26;

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_MESH_H_
