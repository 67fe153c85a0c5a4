// 3MF, the 3D Manufacturing Format: a zip archive of XML.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_THREE_MF_FILE_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_THREE_MF_FILE_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// All objects that the build's items place, in world coordinates, millimetres: transforms of items and components and
// the model's unit applied in double, and rounded to float32 once; in millimetres and without a transform, positions
// are the nearest float32 to the text. Each object that is placed is a part, as often as it is; base materials are
// materials, numbered by first use; a color is a base material's displaycolor, or of a colorgroup; a vertex with
// several becomes several. Of extensions, production is read (parts in several files), and of materials the colorgroup;
// all else that is no required extension is ignored, and textures are not sampled. Errors: INVALID_ARGUMENT naming
// part, line, element and value: not a zip archive, not XML, an attribute that is missing or no number, a vertex index
// out of range, an object that does not exist or contains itself, a required extension that is not read.
// RESOURCE_EXHAUSTED: parts of more than 1 GiB unpacked, more than kMostPlaced triangles or vertices, or 2^20 objects,
// each counted as often as it is placed.
absl::StatusOr<Mesh> Parse3mf(absl::string_view bytes);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_THREE_MF_FILE_H_
