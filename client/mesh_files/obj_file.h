// Wavefront OBJ.
#ifndef LATVOX_CLIENT_MESH_FILES_OBJ_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_OBJ_FILE_H_

#include <filesystem>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/parse_options.h"

namespace latvox::client {

// Reads an OBJ file. Positions are the nearest doubles to the decimal text. Polygons are triangulated.
// - Each `o` with faces is a part. In a file without `o`, each `g` with faces is one, unless it repeats the
//   name before it.
// - Materials are the names of `usemtl`, in order of first use.
// - Colors are those of vertices (obj_vertices.h). Without them, colors are `Kd` of the materials, from the files of
//   `mtllib` in the folder. Faces without a color are white then; the warning is PARTIAL_COLORS.
// - Textures are the `map_Kd` of materials. They are read if the options ask for base colors. Otherwise the warning is
//   IGNORED_TEXTURE.
// - Other elements are counted as skipped, with the warning SKIPPED_ELEMENTS: lines, points, curves, surfaces, and
//   statements with an unknown keyword. Texture coordinates, normals and display settings are ignored.
// Errors, or broken elements: INVALID_ARGUMENT naming line, value and limit: an index out of range, a coordinate that
// is not a number, a face of fewer than three corners, a face with a corner that is not finite.
absl::StatusOr<Mesh> ParseObj(absl::string_view text, const ParseOptions& options = {},
                              const std::filesystem::path& folder = "");

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_OBJ_FILE_H_
