// The options that say how a mesh is taken.
#ifndef LATVOX_CLIENT_TOOL_CLI_MESH_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_MESH_OPTIONS_H_

#include <string>
#include <vector>

#include "client/tool/mesh_files/mesh_source.h"
#include "deploy/manual/option_row.h"

namespace latvox::client {

// The words as they are given; parsing writes into them.
struct MeshWords {
  std::string up_axis, scale, input_format;
};

// The positional MESH, one or several.
OptionRow MeshRow(MeshSource& mesh);

// --up-axis, --scale and --input-format.
std::vector<OptionRow> MeshRows(MeshWords& words);

// What the words mean.
void InterpretMesh(const MeshWords& words, MeshSource& mesh);

// Throws UsageError: standard input given twice, an output given twice or in the place of a mesh.
void CheckMeshPaths(const MeshSource& mesh, const std::vector<std::string>& outputs);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_MESH_OPTIONS_H_
