// Cuts polygons into triangles.
#ifndef LATVOX_CLIENT_MESH_FILES_POLYGON_H_
#define LATVOX_CLIENT_MESH_FILES_POLYGON_H_

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "client/mesh/mesh.h"

namespace latvox::client {

// Cuts a polygon with n >= 3 corners into n - 2 triangles with the same corners and orientation, and appends them.
//   convex              cut from the first corner on, quads along corners 1 and 3, as most programs do
//   concave             cut inside
//   not planar          cut as its projection along its mean normal
//   self-intersecting   gets n - 2 triangles that cover all its corners
void Triangulate(std::span<const uint32_t> polygon, const std::vector<Vec3d>& positions,
                 std::vector<std::array<uint32_t, 3>>& triangles);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_POLYGON_H_
