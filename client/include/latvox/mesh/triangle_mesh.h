// A triangle mesh with the attributes that its voxels can carry.
#ifndef LATVOX_LATVOX_MESH_TRIANGLE_MESH_H_
#define LATVOX_LATVOX_MESH_TRIANGLE_MESH_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "latvox/warning.h"

namespace latvox::client {

// Degenerate and duplicate triangles are kept. A program may fill one itself, or read it from a file
// (latvox/mesh_files/read_mesh_file.h). Only the first two members are needed.
struct TriangleMesh {
  std::vector<std::array<double, 3>> positions;     // world coordinates x, y, z; finite
  std::vector<std::array<uint32_t, 3>> triangles;   // indices of positions
  std::vector<uint32_t> parts = {};                 // of each triangle, never descending; empty: all are part 0
  std::vector<uint32_t> materials = {};             // of each triangle; empty: at least one triangle has none
  std::vector<std::array<uint8_t, 3>> colors = {};  // red, green, blue of each position; empty: at least one has none
  uint64_t skipped = 0;                             // points and lines of the file, which have no surface
  std::vector<Warning> warnings = {};               // parts of the file that are perhaps not read as intended
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_MESH_TRIANGLE_MESH_H_
