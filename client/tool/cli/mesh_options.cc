#include "client/tool/cli/mesh_options.h"

#include <algorithm>

#include "client/mesh_files/input.h"
#include "client/tool/cli/common_options.h"

namespace latvox::client {

OptionRow MeshRow(MeshSource& mesh) {
  return {
      .names = "mesh",
      .target = &mesh.paths,
      .help =
          "Mesh file: .drc .obj .ply .stl .off .glb .gltf .3mf, or - for standard input; several files form one mesh",
      .value = "MESH",
      .checks = {{[](const std::string& path) { return path.empty() ? "\"\" names no file" : ""; }}},
      .required = true};
}

std::vector<OptionRow> MeshRows(MeshWords& words) {
  return {
      {.names = "--up-axis",
       .target = &words.up_axis,
       .help = "Axis of the mesh that a quarter turn makes z",
       .words = WordsOf(UpNames()),
       .word_help = {"no turn", "x becomes z", "y becomes z"},
       .standard = "z, without a turn"},
      {.names = "--scale",
       .target = &words.scale,
       .help = "Factor of the mesh's coordinates, applied after --up-axis",
       .value = "FACTOR",
       .checks = {{CheckPositive}},
       .standard = "1"},
      {.names = "--skip-bad",
       .target = &words.skip_bad,
       .help = "Leave out broken elements, such as faces with a corner that is not finite, and count them"},
      {.names = "--input-format",
       .target = &words.input_format,
       .help = "Format of the mesh, in place of its extension or its first bytes",
       .words = WordsOf(MeshFormats()),
       .word_help = {"Draco", "Wavefront", "Stanford polygons", "stereolithography", "glTF, binary", "glTF, JSON",
                     "3D Manufacturing Format"}},
      {.names = "--strict", .target = &words.strict, .help = "Make every warning an error, and write nothing then"}};
}

void InterpretMesh(const MeshWords& words, MeshSource& mesh) {
  if (!words.up_axis.empty()) mesh.up = ValueNamed(UpNames(), words.up_axis);
  if (!words.scale.empty()) ParseNumber(words.scale, mesh.scale);
  mesh.skip_bad = words.skip_bad;
  if (!words.input_format.empty()) mesh.format = ValueNamed(MeshFormats(), words.input_format);
}

void CheckMeshPaths(const MeshSource& mesh, const std::vector<std::string>& outputs) {
  if (std::count(mesh.paths.begin(), mesh.paths.end(), kStandardInput) > 1) {
    Refuse("mesh: - is given twice, but standard input can be read only once");
  }
  for (const std::string& path : mesh.paths) CheckOutputs(outputs, path, "mesh");
}

}  // namespace latvox::client
