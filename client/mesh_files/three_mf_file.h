// 3MF, the 3D Manufacturing Format: a zip archive of XML.
#ifndef LATVOX_CLIENT_MESH_FILES_THREE_MF_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_THREE_MF_FILE_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/parse_options.h"

namespace latvox::client {

// Returns all objects that the items of the build place, in world coordinates, millimeters.
// - Transforms of items and components and the unit of the model are applied in double.
//   In millimeters and without a transform, positions are the nearest doubles to the text.
// - Each placed object is a part, as often as it is placed.
// - The corners of mirrored triangles are reversed, so that the outside stays outside.
// - Numbers and names may have white space around them; parts are UTF-8 or UTF-16.
// - Objects of all types are placed, with a warning for those that are no models, or are not to be printed.
// - Base materials are materials, numbered by first use. Colors are the displaycolor of a base material, or those of a
//   colorgroup. A vertex with several colors becomes several vertices. Beside colored triangles, those without a color
//   are white, with a warning.
// - Extensions: production is read (parts in several files). So are the colorgroup of materials, and its texture2dgroup
//   if the options ask for base colors. Slices and sets of triangles may be required, because they leave the mesh
//   alone. Everything else that is not a required extension is ignored.
// - With options.skip_bad, triangles are left out if their indices or vertices are wrong.
// Errors:
//   INVALID_ARGUMENT     names part, line, element and value: not a zip archive; not XML; an attribute that is missing
//                        or not a number, a vertex index out of range, an object that does not exist or contains
//                        itself, a required extension that is not read
//   RESOURCE_EXHAUSTED   parts of more than 1 GiB unpacked; more than kMostPlaced triangles or vertices, or 2^20
//                        objects, each counted as often as it is placed
absl::StatusOr<Mesh> Parse3mf(absl::string_view bytes, const ParseOptions& options = {});

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_THREE_MF_FILE_H_
