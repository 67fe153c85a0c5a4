// Draco streams that the tool decodes.
#ifndef LATVOX_CLIENT_MESH_FILES_DRACO_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_DRACO_FILE_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// Unique ids of the attributes to read.
struct DracoIds {
  std::optional<uint32_t> positions = std::nullopt;  // absent: the attribute that the stream marks as positions
  std::vector<uint32_t> numbers = {};                // of other attributes
};

// The numbers of an attribute, one vertex after the other.
struct DracoNumbers {
  size_t components = 0;
  double full = 1;  // the full intensity of a color in these numbers
  std::vector<double> values = {};
};

// Reads positions and triangles of a Draco mesh, and writes the numbers of ids.numbers, in their order. Without
// ids.positions, the mesh has the colors that the stream marks as such, clamped to 0 and full intensity. Draco may take
// much time and memory before it reports a damaged stream. Errors: INVALID_ARGUMENT: not a Draco mesh, positions that
// are not three floats, a vertex that is not finite or has no number of an attribute, an index out of range;
// RESOURCE_EXHAUSTED (memory).
absl::StatusOr<Mesh> ParseDraco(absl::string_view bytes, const DracoIds& ids = {},
                                std::vector<DracoNumbers>* numbers = nullptr);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_DRACO_FILE_H_
