// Facts about numpy's files.
#ifndef LATVOX_CLIENT_TOOL_INSPECT_ARRAY_FACTS_H_
#define LATVOX_CLIENT_TOOL_INSPECT_ARRAY_FACTS_H_

#include <string>

#include "absl/status/statusor.h"
#include "client/json/json.h"
#include "client/tool/inspect/byte_source.h"

namespace latvox::client {

// Returns `type` and `shape` of a .npy file; of arrays that latvox writes also `voxels` and, for lists, `index_box`.
// Reads the whole file. Errors: INVALID_ARGUMENT: damaged, cut short, Fortran order, rows of more than 1 KiB.
absl::StatusOr<Json> NpyFacts(FileSource& file);

// Returns `arrays` of a .npz file, their types and shapes; of a file that latvox wrote also `voxels`, `index_box` (of
// the array), `basis` and `origin`. Errors: as above; not a zip archive; an array of more than 2^32 elements; more than
// 1000 members.
absl::StatusOr<Json> NpzFacts(const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_INSPECT_ARRAY_FACTS_H_
