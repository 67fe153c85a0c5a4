// A report on duplicate vertices and on edges.
#ifndef LATVOX_CLIENT_MESH_FILES_WELD_REPORT_H_
#define LATVOX_CLIENT_MESH_FILES_WELD_REPORT_H_

#include <cstdint>

#include "client/mesh/mesh.h"

namespace latvox::client {

// Vertices at the same position count as one. Edges are those of triangles that are not degenerate.
struct WeldReport {
  uint64_t vertices = 0, triangles = 0;  // as in the file
  uint64_t duplicate_vertices = 0;       // at the position of an earlier vertex
  uint64_t degenerate_triangles = 0;     // with two corners at one position
  uint64_t open_edges = 0;               // of one triangle
  uint64_t non_manifold_edges = 0;       // of three or more
  uint64_t inconsistent_edges = 0;       // with two triangles of opposite orientation
};

WeldReport Weld(const Mesh& mesh);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_WELD_REPORT_H_
