#include "client/tool/cli/mesh_options.h"

#include <algorithm>

#include "client/tool/cli/common_options.h"
#include "client/tool/mesh_files/input.h"

namespace latvox::client {

OptionRow MeshRow(MeshSource& mesh) {
  return {.names = "mesh",
          .target = &mesh.paths,
          .help = "mesh file: .drc .obj .ply .stl .glb .gltf .3mf, or - for standard input; several are one mesh",
          .value = "MESH",
          .required = true};
}

std::vector<OptionRow> MeshRows(MeshWords& words) {
  return {{.names = "--up-axis",
           .target = &words.up_axis,
           .help = "the mesh's axis that becomes z, by a quarter turn (default: z, as it is)",
           .words = WordsOf(UpNames())},
          {.names = "--scale",
           .target = &words.scale,
           .help = "multiply the mesh's coordinates, after --up-axis",
           .value = "S",
           .checks = {{CheckPositive}}},
          {.names = "--input-format",
           .target = &words.input_format,
           .help = "of MESH, whatever its extension and its first bytes say",
           .words = WordsOf(MeshFormats())}};
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
