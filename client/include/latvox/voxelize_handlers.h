// Functions that a running voxelization calls.
#ifndef LATVOX_LATVOX_VOXELIZE_HANDLERS_H_
#define LATVOX_LATVOX_VOXELIZE_HANDLERS_H_

#include <functional>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "latvox/types.h"

namespace latvox::client {

// A broken stream that continues.
struct Resumption {
  std::optional<Vec3i> after_tile;  // the last 64^3 tile passed on, lattice coordinates >> 6; absent: none was
  std::string address;              // of the server that continues
  absl::Status cause;               // the end of the stream before
};

// They run on the thread that called Voxelize, one at a time. A status that is not OK ends the call, and Voxelize
// returns it: absl::CancelledError() is the plain way to stop. Empty functions are skipped.
struct VoxelizeHandlers {
  std::function<absl::Status(const Accepted&)> on_accepted = {};   // once, first
  std::function<absl::Status(const BrickBatch&)> on_bricks = {};   // the server waits while it runs
  std::function<absl::Status(const Resumption&)> on_resumed = {};  // before the bricks of the next stream
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_VOXELIZE_HANDLERS_H_
