#include "client/internal/attempt.h"

#include <algorithm>
#include <optional>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "client/internal/channel_security.h"
#include "client/internal/wire.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

// The trailer that tells gRPC's own retries when to come back, in milliseconds; below 0: never.
constexpr char kPushbackTrailer[] = "grpc-retry-pushback-ms";

std::optional<int64_t> PushbackOf(const grpc::ClientContext& context) {
  const auto& trailers = context.GetServerTrailingMetadata();
  const auto found = trailers.find(kPushbackTrailer);
  int64_t milliseconds = 0;
  if (found == trailers.end()) return std::nullopt;
  return absl::SimpleAtoi(absl::string_view(found->second.data(), found->second.size()), &milliseconds) ? milliseconds
                                                                                                        : -1;
}

// gRPC has more than one code for a broken connection: usually UNAVAILABLE, but INTERNAL, UNKNOWN or CANCELLED where
// the peer, or a proxy, reset the stream. An INTERNAL or UNKNOWN from a latvox server has a reason. A CANCELLED of the
// caller's own does not get here.
bool MayPassByItself(const absl::Status& status, const ErrorDetails& details, bool asked_to_come_back) {
  switch (status.code()) {
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kCancelled:
      return true;
    case absl::StatusCode::kInternal:
    case absl::StatusCode::kUnknown:
      return details.reason.empty();
    case absl::StatusCode::kResourceExhausted:
      // The gRPC of a server that is short of memory resets streams, too.
      return asked_to_come_back || (details.reason.empty() && absl::StrContains(status.message(), "RST_STREAM"));
    default:
      return false;
  }
}

}  // namespace

absl::Status CancelledByCaller() { return absl::CancelledError("cancelled by the caller"); }

Attempt::Attempt(const CallOptions& options, const Credentials& credentials)
    : options_(options), on_cancel_(options.cancellation, [this] { context_.TryCancel(); }) {
  if (options.deadline) context_.set_deadline(absl::ToChronoTime(*options.deadline));
  AddCallMetadata(credentials, options, context_);
}

// gRPC's own messages for the two ends that the caller caused say less than these.
AttemptEnd Attempt::End(const grpc::Status& status) const {
  if (status.ok()) return {};
  if (options_.cancellation.cancelled()) return {CancelledByCaller()};
  if (status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED) {
    return {absl::DeadlineExceededError("the deadline passed before the server was done")};
  }
  AttemptEnd end{FromGrpc(status)};
  const ErrorDetails details = GetErrorDetails(end.status);
  const std::optional<int64_t> pushback = PushbackOf(context_);
  const bool come_back = details.retry_after || pushback;
  if (MayPassByItself(end.status, details, come_back) && pushback.value_or(0) >= 0) {
    end.retry = AttemptEnd::Retry::kLater;
  }
  end.wait = std::max(details.retry_after.value_or(absl::ZeroDuration()), absl::Milliseconds(pushback.value_or(0)));
  return end;
}

}  // namespace latvox::client
