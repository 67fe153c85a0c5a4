#include "server/call.h"

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

}  // namespace latvox
