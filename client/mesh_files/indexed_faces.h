// Faces as lists of vertices, which are counted from 0.
#ifndef LATVOX_CLIENT_MESH_FILES_INDEXED_FACES_H_
#define LATVOX_CLIENT_MESH_FILES_INDEXED_FACES_H_

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// Returns the vertex that the nth element of this kind refers to. Errors: INVALID_ARGUMENT, if the index is not a whole
// number below the number of positions, or the position is not finite.
absl::StatusOr<uint32_t> ToVertex(double index, const char* element, uint64_t n, const std::vector<Vec3d>& positions);

// Appends the triangles of face n. Counts a face of fewer than three corners as skipped; the first one gives the
// warning SKIPPED_ELEMENTS. Errors: as ToVertex; then the mesh stays as it is.
absl::Status AppendFace(const std::vector<double>& indices, uint64_t n, Mesh& mesh);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_INDEXED_FACES_H_
