// The names that the mesh's file gives to parts and materials.
#ifndef LATVOX_CLIENT_TOOL_CLI_MESH_NAMES_H_
#define LATVOX_CLIENT_TOOL_CLI_MESH_NAMES_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"
#include "latvox/grid/carried_names.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns the names of these attributes: none, or one for each part or material of the mesh.
CarriedNames NamesOf(const Mesh& mesh, const std::vector<Field>& attributes);

// Returns the labels that the words of an option name: a number, or the numbers with a name, larger ones first.
// Errors: INVALID_ARGUMENT, naming the option: a word is neither.
absl::StatusOr<std::vector<uint32_t>> LabelsNamed(const std::vector<std::string>& words, const std::string& option,
                                                  Field labels, const CarriedNames& names);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_MESH_NAMES_H_
