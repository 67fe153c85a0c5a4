// The common layouts of a binary Stanford PLY file, as arrays.
#ifndef LATVOX_CLIENT_MESH_FILES_PLY_ARRAYS_H_
#define LATVOX_CLIENT_MESH_FILES_PLY_ARRAYS_H_

#include <cstdint>

#include "client/mesh/mesh.h"
#include "client/mesh_files/ply_body.h"
#include "client/mesh_files/ply_header.h"

namespace latvox::client {

// Most files have little-endian scalars for vertices, and a byte and three indices for a face. One loop reads them
// four times as fast as numbers one by one. These functions stop at a fault and do not touch what follows. The reader
// of single numbers goes on there, and finds the errors.

// Appends the positions of the next vertices: all that the bytes are enough for. Returns their number: 0 if the element
// has a list, or x, y and z are not all float or all double. Colors are not read.
uint64_t ReadVertexArray(const PlyElement& element, PlyBody& body, Mesh& mesh);

// Whether faces have one list of 32-bit indices and nothing else.
bool IsTriangleArray(const PlyElement& element);

// Appends the next faces up to the first that is no triangle, has an index out of range, or ends beyond the file.
// Returns their number, at most `count`. Preconditions: IsTriangleArray(element); all positions are finite.
uint64_t ReadTriangleArray(const PlyElement& element, uint64_t count, PlyBody& body, Mesh& mesh);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_PLY_ARRAYS_H_
