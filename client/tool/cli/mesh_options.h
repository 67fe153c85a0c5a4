// Options of the input mesh.
#ifndef LATVOX_CLIENT_TOOL_CLI_MESH_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_MESH_OPTIONS_H_

#include <string>
#include <vector>

#include "client/mesh_files/mesh_source.h"
#include "deploy/manual/option_row.h"

namespace latvox::client {

// The words as given. Parsing writes into them.
struct MeshWords {
  std::string up_axis, scale, input_format;
  bool strict = false;    // a warning is an error
  bool skip_bad = false;  // leave out broken elements
};

// Returns the row of the positional MESH, one or several.
OptionRow MeshRow(MeshSource& mesh);

// Returns the rows of --up-axis, --scale, --skip-bad, --input-format and --strict.
std::vector<OptionRow> MeshRows(MeshWords& words);

// Writes the meaning of the words to `mesh`.
void InterpretMesh(const MeshWords& words, MeshSource& mesh);

// Throws UsageError: standard input given twice, an output given twice, an output that is a mesh.
void CheckMeshPaths(const MeshSource& mesh, const std::vector<std::string>& outputs);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_MESH_OPTIONS_H_
