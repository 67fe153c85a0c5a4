// Outputs that list voxels: .csv, .npy, .ply.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_TABLE_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_TABLE_OUTPUT_H_

#include <memory>
#include <vector>

#include "absl/strings/string_view.h"
#include "client/tool/output/atomic_file.h"
#include "client/tool/output/output.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns the output for an extension in lower case: ".csv", ".npy" or ".ply".
//   fields   that voxels carry, in order
std::unique_ptr<Output> NewTableOutput(absl::string_view extension, std::unique_ptr<AtomicFile> file,
                                       const std::vector<Field>& fields);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_TABLE_OUTPUT_H_
