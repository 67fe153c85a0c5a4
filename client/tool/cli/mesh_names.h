// The names that the mesh's file gives to parts and materials.
#ifndef LATVOX_CLIENT_TOOL_CLI_MESH_NAMES_H_
#define LATVOX_CLIENT_TOOL_CLI_MESH_NAMES_H_

#include <vector>

#include "client/mesh/mesh.h"
#include "latvox/grid/carried_names.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns the names of these attributes: none, or one for each part or material of the mesh.
CarriedNames NamesOf(const Mesh& mesh, const std::vector<Field>& attributes);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_MESH_NAMES_H_
