#include "client/tool/cli/mesh_options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "client/tool/cli/common_options.h"
#include "client/tool/mesh_files/input.h"

namespace latvox::client {

void AddMeshes(CLI::App& command, MeshSource& mesh) {
  command
      .add_option("mesh", mesh.paths,
                  "mesh file: .drc .obj .ply .stl .glb .gltf .3mf, or - for standard input; several are one mesh")
      ->type_name("MESH")
      ->required();
}

void AddMeshOptions(CLI::App& command, MeshWords& words) {
  command.add_option("--up-axis", words.up_axis, "the mesh's axis that becomes z, by a quarter turn (default: z, as it is)")
      ->check(OneOf(UpNames()));
  command.add_option("--scale", words.scale, "multiply the mesh's coordinates, after --up-axis")
      ->type_name("S")
      ->check(CheckPositive);
  command.add_option("--input-format", words.input_format, "of MESH, whatever its extension and its first bytes say")
      ->check(OneOf(MeshFormats()));
}

void InterpretMesh(const MeshWords& words, MeshSource& mesh) {
  if (!words.up_axis.empty()) mesh.up = ValueNamed(UpNames(), words.up_axis);
  if (!words.scale.empty()) ParseNumber(words.scale, mesh.scale);
  if (!words.input_format.empty()) mesh.format = ValueNamed(MeshFormats(), words.input_format);
}

void CheckMeshPaths(const MeshSource& mesh, const std::vector<std::string>& outputs) {
  if (std::count(mesh.paths.begin(), mesh.paths.end(), kStandardInput) > 1) {
    Refuse("mesh: - is given twice, but read once");
  }
  for (const std::string& path : mesh.paths) CheckOutputs(outputs, path, "mesh");
}

}  // namespace latvox::client
