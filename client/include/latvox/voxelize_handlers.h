// What a voxelization tells while it runs.
#ifndef LATVOX_LATVOX_VOXELIZE_HANDLERS_H_
#define LATVOX_LATVOX_VOXELIZE_HANDLERS_H_

#include <functional>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "latvox/types.h"

namespace latvox::client {

// A broken stream goes on.
struct Resumption {
  std::optional<Vec3i> after_tile;  // the last 64^3 tile handed on, lattice coordinates >> 6; absent: none was
  std::string address;              // of the server that goes on
  absl::Status cause;               // how the stream before ended
};

// They run on the thread that called Voxelize, one at a time. Anything but OK ends the call, and Voxelize returns it:
// absl::CancelledError() is the plain way to stop. Empty functions are skipped.
struct VoxelizeHandlers {
  std::function<absl::Status(const Accepted&)> on_accepted = {};   // once, first
  std::function<absl::Status(const BrickBatch&)> on_bricks = {};   // while it runs, the server is held back
  std::function<absl::Status(const Resumption&)> on_resumed = {};  // before the bricks that the next stream brings
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_VOXELIZE_HANDLERS_H_
