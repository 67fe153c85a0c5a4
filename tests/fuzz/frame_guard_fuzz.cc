// The bytes of a foreign client's connection. The guard judges them alike, whatever the pieces.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>

#include "absl/strings/string_view.h"
#include "server/guard/frame_guard.h"

namespace {

std::optional<latvox::Offense> Judge(absl::string_view bytes, size_t piece) {
  latvox::FrameGuard guard;
  latvox::FrameWork work;
  std::optional<latvox::Offense> offense;
  for (size_t at = 0; at < bytes.size() && !offense; at += std::min(piece, bytes.size() - at)) {
    offense = guard.Receive(bytes.substr(at, piece), work);
    if (work.all < work.unasked || work.unasked < 0) std::abort();
  }
  return offense;
}

}  // namespace

// Byte 0: the size of pieces. Then a connection.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 1) return 0;
  const absl::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (Judge(bytes, SIZE_MAX) != Judge(bytes, data[0] + size_t{1})) std::abort();
  return 0;
}
