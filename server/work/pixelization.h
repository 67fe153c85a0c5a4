// One request's work for Pixelize. It does not know gRPC.
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

// The results and times of a pixelization so far.
struct PixelizationFacts {
  std::string lattice;  // empty: the request was not valid
  int separability = 0;
  uint64_t points = 0, pixels = 0;
  double pixelize_ms = 0;
};

// Returns whether the request may take more than some 50 ms of a core, as far as an unchecked drawing tells.
bool LastsLong(const v1::PixelizeRequest& request);

// Answers the request, and reserves memory before it is used. Ends soon once cancelled. Errors: as the contract;
// CANCELLED; INTERNAL; RESOURCE_EXHAUSTED also if memory or the budget runs out. Sets `facts` in every case.
absl::StatusOr<v1::PixelizeResponse> PixelizePolylines(const v1::PixelizeRequest& request, const Limits& limits,
                                                       MemoryReservation& memory, StopSignal stop,
                                                       PixelizationFacts& facts);

}  // namespace latvox

#endif  // LATVOX_SERVER_WORK_PIXELIZATION_H_
