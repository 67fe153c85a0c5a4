// What joining equal vertices shows of a mesh.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_WELD_REPORT_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_WELD_REPORT_H_

#include <cstdint>

#include "client/mesh/mesh.h"

namespace latvox::client {

// Vertices in the same place count as one. Edges are those of the triangles that are not degenerate.
struct WeldReport {
  uint64_t vertices = 0, triangles = 0;  // as the file has them
  uint64_t duplicate_vertices = 0;       // in the place of one before them
  uint64_t degenerate_triangles = 0;     // with two corners in one place
  uint64_t open_edges = 0;               // of one triangle
  uint64_t non_manifold_edges = 0;       // of three or more
  uint64_t inconsistent_edges = 0;       // of two that pass them the same way: one of both is turned over
};

WeldReport Weld(const Mesh& mesh);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_WELD_REPORT_H_
