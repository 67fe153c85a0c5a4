// A triangle mesh as the client reads and encodes it.
#ifndef LATVOX_CLIENT_MESH_MESH_H_
#define LATVOX_CLIENT_MESH_MESH_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/mesh/base_colors.h"
#include "latvox/types.h"
#include "latvox/warning.h"

namespace latvox::client {

using Color = std::array<uint8_t, 3>;  // red, green, blue

// Consecutive triangles, up to the first of the next stretch.
struct Stretch {
  size_t first = 0;                                 // triangle
  uint32_t part = 0;                                // index of an object of a scene, or of one of several meshes
  std::optional<uint32_t> material = std::nullopt;  // below Mesh::materials
};

// Triangles index positions. Degenerate and duplicate triangles are kept: the mesh equals the file.
struct Mesh {
  std::vector<Vec3d> positions;                    // world, finite, as the file has them
  std::vector<std::array<uint32_t, 3>> triangles;  // each index < positions.size()
  uint64_t skipped = 0;                            // points and lines of the file, which have no surface
  std::vector<Stretch> stretches = {};           // in order, parts ascending; none: all are part 0, without a material
  uint32_t materials = 0;                        // the number of materials that stretches name
  std::vector<Color> colors = {};                // one for each position; fewer: some positions have none
  std::vector<Warning> warnings = {};            // parts of the file that are perhaps not read as intended
  std::vector<std::string> part_names = {};      // by number, as far as the file names its parts; "": unknown
  std::vector<std::string> material_names = {};  // likewise
  std::string no_color = {};  // the reason why some of the file's colors are missing; empty: there are no others
  // If ParseOptions ask for them. A triangle's image counts, not the colors of its corners.
  BaseColors base_colors = {};
};

// The most triangles, and the most vertices, that a scene may place in all; it may place one mesh many times.
inline constexpr size_t kMostPlaced = size_t{1} << 26;

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_MESH_H_
