// A whole Pixelize request, from its bytes to pixels. Every input gives a clean status, or pixels without tunnels.
#include <cstdint>
#include <cstdlib>

#include "core/base/stop_signal.h"
#include "server/work/pixelization.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  latvox::v1::PixelizeRequest request;
  if (!request.ParseFromArray(data, static_cast<int>(size))) return 0;
  // Brute force may take minutes for a request within all limits.
  if (request.algorithm() == latvox::v1::LINE_ALGORITHM_BRUTE_FORCE) return 0;
  latvox::Limits limits;
  limits.max_message_bytes = 1 << 16;
  latvox::PixelizationFacts facts;
  latvox::MemoryBudget budget(limits.memory_budget_bytes);
  latvox::MemoryReservation memory(budget);
  const auto response = latvox::PixelizePolylines(request, limits, memory, latvox::StopSignal(), facts);
  if (!response.ok()) return 0;
  if (response->tunnels() != 0 || response->ByteSizeLong() > limits.max_message_bytes) std::abort();
  if ((!request.has_minimal() || request.minimal()) && response->redundant() != 0) std::abort();
  return 0;
}
