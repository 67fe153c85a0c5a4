// Several files of one command.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_OUTPUTS_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_OUTPUTS_H_

#include <functional>
#include <memory>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "client/tool/output/output.h"
#include "latvox/cancellation.h"

namespace latvox::client {

using Outputs = std::vector<std::unique_ptr<Output>>;

// Calls step(output) with all outputs, at once on at most as many threads as there are cores. Memory: what the outputs
// take at the same time. Every step ends, whether others fail or not, so the error does not depend on threads: it is
// that of the first output that has one. Steps that have not begun when the call is cancelled are left out.
// Where a process may have few addresses, the outputs take turns. Errors: CANCELLED; RESOURCE_EXHAUSTED (memory); those
// of the steps.
absl::Status ForAllAtOnce(const Outputs& outputs, const Cancellation& cancellation,
                          const std::function<absl::Status(Output&)>& step);

// Calls add(batch) with some hundred bricks of `all` at a time, in their order, as those of a call come: so a file's
// voxels do not keep an output busy for long. Memory: the fields of these bricks. Errors: CANCELLED; the first of add.
absl::Status AddInPieces(const BrickBatch& all, const Cancellation& cancellation,
                         absl::FunctionRef<absl::Status(const BrickBatch&)> add);

// Returns the warnings of all outputs, in their order.
std::vector<Warning> WarningsOf(const Outputs& outputs);

// Gives all files their names, in order, until one fails.
absl::Status CommitAll(const Outputs& outputs);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_OUTPUTS_H_
