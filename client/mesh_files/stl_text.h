// STL as text.
#ifndef LATVOX_CLIENT_MESH_FILES_STL_TEXT_H_
#define LATVOX_CLIENT_MESH_FILES_STL_TEXT_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/parse_options.h"

namespace latvox::client {

// Reads the text, as ParseStl says.
absl::StatusOr<Mesh> ParseStlText(absl::string_view text, const ParseOptions& options);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_STL_TEXT_H_
