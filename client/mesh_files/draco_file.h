// Draco streams that the tool decodes.
#ifndef LATVOX_CLIENT_MESH_FILES_DRACO_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_DRACO_FILE_H_

#include <cstdint>
#include <optional>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// Unique ids of the attributes to read.
struct DracoIds {
  std::optional<uint32_t> positions = std::nullopt;  // absent: the attribute that the stream marks as positions
  std::optional<uint32_t> colors = std::nullopt;     // absent: no colors
};

// Reads positions, triangles and colors of a Draco mesh. Draco may take much time and memory before it reports a
// damaged stream.
// Errors: INVALID_ARGUMENT: not a Draco mesh, positions that are not three floats, a vertex that is not finite or has
// no color, an index out of range; RESOURCE_EXHAUSTED (memory).
absl::StatusOr<Mesh> ParseDraco(absl::string_view bytes, const DracoIds& ids = {});

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_DRACO_FILE_H_
