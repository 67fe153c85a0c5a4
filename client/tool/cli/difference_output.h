// Files of the difference between two voxel sets.
#ifndef LATVOX_CLIENT_TOOL_CLI_DIFFERENCE_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_CLI_DIFFERENCE_OUTPUT_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tool/cli/compare_command.h"
#include "client/tool/output/atomic_file.h"
#include "latvox/cancellation.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {

// Writes the outputs, which appear when they are committed:
//   .vdb   see client/grid/difference_file.h
//   .png   a picture of the voxels of both files, colored by their marks
// Errors: FAILED_PRECONDITION, with the path; those of WriteDifferenceFile and DrawVoxels.
// Precondition: equal coordinates are equal positions in both files.
absl::StatusOr<std::vector<std::unique_ptr<AtomicFile>>> WriteDifferences(const CompareWords& words,
                                                                          const GridContent& a, const GridContent& b,
                                                                          const Cancellation& cancellation);

// Returns the meaning of a picture's colors, one line.
std::string DifferenceColorsText();

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_DIFFERENCE_OUTPUT_H_
