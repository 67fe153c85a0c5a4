// Work that nothing can stop, such as Draco's encoding. The caller can stop waiting for it.
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

// Returns CANCELLED if the call is cancelled, DEADLINE_EXCEEDED if its deadline has passed.
absl::Status CheckTime(const CallOptions& call);

// Runs `work` on its own thread and waits for it. Returns true when it has ended. Returns false when the call is
// cancelled or its deadline passes first. The thread then goes on, so `work` must own everything that it uses.
bool AwaitWork(std::function<void()> work, const CallOptions& call);

// Returns whether any thread was ever abandoned, even if it has ended since. The process must then end by _exit, which
// destroys nothing that such a thread may still use.
bool AnyAbandoned();

// Returns the absl::StatusOr of work(), or the error of CheckTime. Exceptions of work() pass through.
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
