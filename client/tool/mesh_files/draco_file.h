// Draco streams that are not sent as they are.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_DRACO_FILE_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_DRACO_FILE_H_

#include <cstdint>
#include <optional>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// Which of a stream's attributes are what, by their unique ids.
struct DracoIds {
  std::optional<uint32_t> positions = std::nullopt;  // else those that the stream calls so
  std::optional<uint32_t> colors = std::nullopt;     // else none
};

// Positions, triangles and colors of a Draco mesh. Of a damaged stream, Draco may take much time and memory before it
// says so. Errors: INVALID_ARGUMENT: no Draco mesh, positions that are not three floats, a vertex that is not finite or
// has no color, an index out of range; RESOURCE_EXHAUSTED (memory).
absl::StatusOr<Mesh> ParseDraco(absl::string_view bytes, const DracoIds& ids = {});

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_DRACO_FILE_H_
