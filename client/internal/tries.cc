#include "client/internal/tries.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/notification.h"

namespace latvox::client {
namespace {

// The longest wait that a server may ask for.
constexpr absl::Duration kLongestWaitAsked = absl::Minutes(1);

// The last error, with the number of tries.
absl::Status GaveUp(const absl::Status& last, int tries) {
  if (tries == 1) return last;
  absl::Status status(last.code(), absl::StrCat(last.message(), " (the last of ", tries, " tries)"));
  last.ForEachPayload(
      [&status](absl::string_view type, const absl::Cord& payload) { status.SetPayload(type, payload); });
  return status;
}

}  // namespace

Tries::Tries(Connection& connection, const CallOptions& options, const MeshId* mesh)
    : connection_(connection), options_(options), mesh_(mesh), tried_(connection.size(), false) {
  server_ = connection_.Pick(tried_, mesh_).value_or(0);
}

void Tries::Progress() {
  tried_.assign(tried_.size(), false);
  asked_for_ = absl::ZeroDuration();
  rounds_ = failures_ = 0;
}

absl::Status Tries::Again(const AttemptEnd& end) {
  ++failures_;
  if (end.retry == AttemptEnd::Retry::kNever || options_.retry.max_retries <= 0) return end.status;
  tried_[server_] = true;
  asked_for_ = std::min(std::max(asked_for_, end.wait), kLongestWaitAsked);
  std::optional<size_t> next = connection_.Pick(tried_, mesh_);
  if (!next) {
    if (end.retry == AttemptEnd::Retry::kElsewhere) return end.status;
    if (rounds_ >= options_.retry.max_retries) return GaveUp(end.status, failures_);
    if (absl::Status status = Wait(asked_for_ + Jitter(), end.status); !status.ok()) return status;
    ++rounds_;
    tried_.assign(tried_.size(), false);
    asked_for_ = absl::ZeroDuration();
    next = connection_.Pick(tried_, mesh_);
  }
  server_ = *next;
  return absl::OkStatus();
}

absl::Status Tries::Wait(absl::Duration duration, const absl::Status& because) const {
  if (options_.deadline && absl::Now() + duration >= *options_.deadline) {
    return absl::DeadlineExceededError(
        absl::StrCat("the deadline passes before the next try; the last one ended with: ", because.message()));
  }
  absl::Notification cancelled;
  const Cancellation::Subscription on_cancel(options_.cancellation, [&cancelled] { cancelled.Notify(); });
  return cancelled.WaitForNotificationWithTimeout(duration) ? CancelledByCaller() : absl::OkStatus();
}

// "Full jitter": clients that lost the same server do not come back together.
absl::Duration Tries::Jitter() const {
  const absl::Duration most =
      std::min(options_.retry.longest_wait, options_.retry.first_wait * std::exp2(std::min(rounds_, 30)));
  std::random_device chance;
  return most * std::uniform_real_distribution<double>(0, 1)(chance);
}

}  // namespace latvox::client
