// One request's work for Pixelize. Knows no gRPC.
#ifndef LATVOX_SERVER_WORK_PIXELIZATION_H_
#define LATVOX_SERVER_WORK_PIXELIZATION_H_

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "core/base/stop_signal.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/base/limits.h"
#include "server/work/memory_budget.h"

namespace latvox {

// What a pixelization has come to so far.
struct PixelizationFacts {
  std::string lattice;  // empty: there was no good request
  int separability = 0;
  uint64_t points = 0, pixels = 0;
  double pixelize_ms = 0;
};

// Whether the request may take more than some 50 ms of a core, as far as its drawing tells before it is checked.
bool LastsLong(const v1::PixelizeRequest& request);

// Answers the request, with what memory it takes reserved before. Ends soon once cancelled.
// Errors: as the contract; CANCELLED; INTERNAL; RESOURCE_EXHAUSTED also if memory runs out, or the budget's. `facts`
// are kept either way.
absl::StatusOr<v1::PixelizeResponse> PixelizePolylines(const v1::PixelizeRequest& request, const Limits& limits,
                                                       MemoryReservation& memory, StopSignal stop,
                                                       PixelizationFacts& facts);

}  // namespace latvox

#endif  // LATVOX_SERVER_WORK_PIXELIZATION_H_
