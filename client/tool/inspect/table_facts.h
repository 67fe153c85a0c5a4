// Facts about lists of voxels.
#ifndef LATVOX_CLIENT_TOOL_INSPECT_TABLE_FACTS_H_
#define LATVOX_CLIENT_TOOL_INSPECT_TABLE_FACTS_H_

#include <optional>

#include "absl/status/statusor.h"
#include "client/json/json.h"
#include "client/tool/inspect/byte_source.h"

namespace latvox::client {

// Returns `columns`, `voxels`, `index_box` and `bounds` (of the centers) of a .csv of voxels; of one of pixels `pixels`
// in place of `voxels`. Reads the whole file. Errors: INVALID_ARGUMENT naming the line: another header, a row with too
// few numbers.
absl::StatusOr<Json> CsvFacts(FileSource& file);

// Returns the same for a .ply of voxel centers; nothing for a .ply that holds anything else, such as a mesh. Errors:
// INVALID_ARGUMENT: a bad header, cut short.
absl::StatusOr<std::optional<Json>> PlyFacts(FileSource& file);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_INSPECT_TABLE_FACTS_H_
