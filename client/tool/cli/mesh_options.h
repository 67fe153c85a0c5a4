// The options that say how a mesh is taken.
#ifndef LATVOX_CLIENT_TOOL_CLI_MESH_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_MESH_OPTIONS_H_

#include <CLI/App.hpp>
#include <string>

#include "client/tool/mesh_files/mesh_source.h"

namespace latvox::client {

// The words as they are given; CLI11 writes into them, so that they must outlive its parsing.
struct MeshWords {
  std::string up_axis, scale, input_format;
};

// Adds the positional MESH, one or several.
void AddMeshes(CLI::App& command, MeshSource& mesh);

// Adds --up-axis, --scale and --input-format.
void AddMeshOptions(CLI::App& command, MeshWords& words);

// What the words mean.
void InterpretMesh(const MeshWords& words, MeshSource& mesh);

// Throws CLI::ValidationError: standard input given twice, an output given twice or in the place of a mesh.
void CheckMeshPaths(const MeshSource& mesh, const std::vector<std::string>& outputs);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_MESH_OPTIONS_H_
