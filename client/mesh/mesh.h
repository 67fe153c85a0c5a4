// A triangle mesh as the client reads and encodes it.
#ifndef LATVOX_CLIENT_MESH_MESH_H_
#define LATVOX_CLIENT_MESH_MESH_H_

#include <array>
#include <cstdint>
#include <vector>

namespace latvox::client {

using Vec3f = std::array<float, 3>;

// Triangles index positions. Degenerate and duplicate triangles are kept: the mesh is what the file says.
struct Mesh {
  std::vector<Vec3f> positions;                    // world, finite
  std::vector<std::array<uint32_t, 3>> triangles;  // each index < positions.size()
  uint64_t skipped = 0;                            // points and lines of the file; they have no surface
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_MESH_H_
