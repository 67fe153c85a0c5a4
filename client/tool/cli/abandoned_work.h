// Work that nothing can stop, such as Draco's encoding: who waits for it need not.
#ifndef LATVOX_CLIENT_TOOL_CLI_ABANDONED_WORK_H_
#define LATVOX_CLIENT_TOOL_CLI_ABANDONED_WORK_H_

#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "absl/status/status.h"
#include "latvox/call_options.h"

namespace latvox::client {

// CANCELLED if the call is cancelled, DEADLINE_EXCEEDED if its deadline has passed.
absl::Status CheckTime(const CallOptions& call);

// Runs `work` on a thread of its own. Waits for its end, and returns true; or, if the call is cancelled or its deadline
// passes before, returns false: then the thread goes on, if it has begun, and `work` must own all that it uses.
bool AwaitWork(std::function<void()> work, const CallOptions& call);

// Whether any thread went on so, be it that it has ended since. Then the process is to end by _exit, which destroys
// nothing that such a thread may use, if only to end.
bool AnyAbandoned();

// What work() returns, an absl::StatusOr, or throws; or the error of CheckTime.
template <class Work>
auto DoAbandonably(Work work, const CallOptions& call) -> decltype(work()) {
  struct Outcome {
    std::optional<decltype(work())> result;
    std::exception_ptr exception;
  };
  const auto outcome = std::make_shared<Outcome>();
  const auto run = [outcome, work = std::move(work)]() mutable {
    try {
      outcome->result.emplace(work());
    } catch (...) {
      outcome->exception = std::current_exception();
    }
  };
  if (!AwaitWork(run, call)) return CheckTime(call);
  if (outcome->exception) std::rethrow_exception(outcome->exception);
  return *std::move(outcome->result);
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_ABANDONED_WORK_H_
