// Facts about VTK's files of voxels.
#ifndef LATVOX_CLIENT_TOOL_INSPECT_VTK_FACTS_H_
#define LATVOX_CLIENT_TOOL_INSPECT_VTK_FACTS_H_

#include "absl/status/statusor.h"
#include "client/json/json.h"
#include "client/tool/inspect/byte_source.h"

namespace latvox::client {

// Both return `arrays`, their types, and `voxels`; of a .vti also `shape`, and `low_corner` and `cell`, the place and
// the sides of its first cell. They read the elements of a .vti's first array, and no others. Errors: INVALID_ARGUMENT:
// no such file of latvox, damaged, cut short.
absl::StatusOr<Json> VtiFacts(FileSource& file);
absl::StatusOr<Json> VtuFacts(FileSource& file);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_INSPECT_VTK_FACTS_H_
