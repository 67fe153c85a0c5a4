#include "server/call.h"

#include <grpc/grpc.h>

#include <chrono>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "server/errors.h"

namespace latvox {

grpc::Status StatusForClient(const absl::Status& status, grpc::CallbackServerContext& context) {
  if (const auto delay = RetryDelayOf(status)) {
    context.AddTrailingMetadata(kPushbackTrailer, absl::StrCat(absl::ToInt64Milliseconds(*delay)));
  } else if (status.code() == absl::StatusCode::kResourceExhausted) {
    context.AddTrailingMetadata(kPushbackTrailer, "-1");
  }
  return ToGrpcStatus(status);
}

absl::Status CancellationOf(const grpc::CallbackServerContext& context) {
  const bool late = context.deadline() <= std::chrono::system_clock::now();
  return late ? absl::DeadlineExceededError("the client's deadline has passed")
              : absl::CancelledError("the client cancelled the call, or is gone");
}

absl::Status StalledClient(absl::Duration patience) {
  return WithRetry(
      MakeError(absl::StatusCode::kUnavailable,
                absl::StrCat("the client has neither sent nor taken anything for ", absl::FormatDuration(patience)),
                {"CLIENT_STALLED", "", "", absl::FormatDuration(patience)}),
      absl::ZeroDuration());
}

// What TryCancel does, with a status.
void CallCanceller::Cancel(const absl::Status& status) {
  const grpc::Status sent = ToGrpcStatus(status);
  const std::lock_guard lock(mu_);
  if (over_) return;
  grpc_call_cancel_with_status(context_.c_call(), static_cast<grpc_status_code>(sent.error_code()),
                               sent.error_message().c_str(), nullptr);
}

}  // namespace latvox
