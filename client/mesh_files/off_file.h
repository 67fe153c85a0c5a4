// OFF, the object file format of Geomview.
#ifndef LATVOX_CLIENT_MESH_FILES_OFF_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_OFF_FILE_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/parse_options.h"

namespace latvox::client {

// Reads an OFF file's bytes, text or binary (OFF BINARY), in which numbers are big-endian.
// - Positions are the nearest doubles to the decimal text, or the float32 of the file. Polygons are triangulated.
// - Colors are those of vertices (COFF), red, green, blue and perhaps opacity. Without them, colors are those of faces.
//   If there are both, the warning is IGNORED_COLOR. Normals (NOFF) and texture coordinates (STOFF) are ignored.
// - An index into a map of colors, in place of a face's color, gives IGNORED_COLOR, because the file has no map.
// - In text, each vertex and each face is a line. More values than the header tells give the warning EXTRA_VALUES. Data
//   after the last face give TRAILING_DATA.
// Errors: INVALID_ARGUMENT naming the line, or the element counted from 0, value and limit: the header; fewer elements
// than it tells. Errors, or broken elements: too few numbers of an element, a word that is not a number, a vertex index
// out of range, a face with a vertex that is not finite.
absl::StatusOr<Mesh> ParseOff(absl::string_view bytes, const ParseOptions& options = {});

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_OFF_FILE_H_
