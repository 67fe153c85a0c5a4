// The bytes between a process that reads a foreign file and its parent. Both are the same program.
#ifndef LATVOX_CLIENT_TOOL_CONFINED_CONTENT_WIRE_H_
#define LATVOX_CLIENT_TOOL_CONFINED_CONTENT_WIRE_H_

#include <cstddef>
#include <functional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {

// Writes or reads exactly so many bytes.
using SendBytes = std::function<void(const void* from, size_t bytes)>;
using ReceiveBytes = std::function<absl::Status(void* to, size_t bytes)>;

// Sends a content or an error. The content may be facts alone, without bricks.
void SendContent(const absl::StatusOr<GridContent>& content, const SendBytes& send);

// Receives either. A malicious file may control the sender, so a content has only the properties that this function
// checks: bricks are in order, in range and not empty; counts of voxels and values agree; numbers are finite. Memory
// grows with the bytes that come, not with the counts that they claim. Errors: those of `receive`;
// DATA_LOSS: a property does not hold; the sender's, of its two kinds INVALID_ARGUMENT and RESOURCE_EXHAUSTED.
absl::StatusOr<GridContent> ReceiveContent(bool facts_alone, const ReceiveBytes& receive);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CONFINED_CONTENT_WIRE_H_
