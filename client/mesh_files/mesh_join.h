// Joins several meshes.
#ifndef LATVOX_CLIENT_MESH_FILES_MESH_JOIN_H_
#define LATVOX_CLIENT_MESH_FILES_MESH_JOIN_H_

#include "absl/status/status.h"
#include "client/mesh/affine.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// Moves the mesh. A mirror image keeps its outside: the order of corners changes.
// Errors: INVALID_ARGUMENT naming the first vertex whose new position is not finite.
absl::Status Transform(const Affine& to_world, Mesh& mesh);

// Appends the moved part with its own vertices. Its parts and materials are numbered after those of the mesh.
// Errors: as Transform, before anything is appended; INVALID_ARGUMENT if there are more than 2^32 - 1 vertices.
absl::Status Append(Mesh part, const Affine& to_world, Mesh& mesh);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_MESH_JOIN_H_
