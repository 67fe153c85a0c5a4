// The log's one line for each request.
#ifndef LATVOX_SERVER_CALLS_REQUEST_LOG_H_
#define LATVOX_SERVER_CALLS_REQUEST_LOG_H_

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "absl/status/status.h"
#include "server/access/call_origin.h"
#include "server/base/log.h"
#include "server/work/computation.h"
#include "server/work/pixelization.h"

namespace latvox {

struct RequestRecord {
  CallOrigin origin;
  absl::Status status;
  std::string lattice;  // empty: the specification was not valid
  int separability = 0;
  std::variant<std::monostate, ComputationFacts, PixelizationFacts> work;  // none: the call did not reach its work
  uint64_t bytes_in = 0;                                                   // encoded mesh; for Pixelize the message
  uint64_t bytes_out = 0;                                                  // messages
  double total_ms = 0;
  std::optional<double> upload_ms, queue_ms;  // for a stage that the call went through to its end
};

// Writes at `level`; writes our own errors at level error.
void LogRequest(const RequestRecord& record, LogLevel level = LogLevel::kInfo);

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_REQUEST_LOG_H_
