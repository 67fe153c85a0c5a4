#include "server/calls/call.h"

#include <google/protobuf/unknown_field_set.h>
#include <grpc/grpc.h>

#include <chrono>
#include <memory>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

// A number that no field of the contract has, now or later.
constexpr int kMark = (1 << 29) - 1;

// The most bytes of tag and length of a message's only field: a piece of a mesh may be as long as the limit.
constexpr uint64_t kFieldHead = 6;

}  // namespace

absl::Status CheckSize(const google::protobuf::Message& message, const Limits& limits) {
  const uint64_t bytes = message.ByteSizeLong();
  return bytes > limits.max_message_bytes + kFieldHead ? LimitExceeded("message_bytes", bytes, limits.max_message_bytes)
                                                       : absl::OkStatus();
}

void DropUnknownFields(google::protobuf::Message& message) {
  const size_t bytes = message.ByteSizeLong();
  message.DiscardUnknownFields();
  if (message.ByteSizeLong() == bytes) return;
  // A message keeps the memory of its former content.
  const std::unique_ptr<google::protobuf::Message> fresh(message.New());
  fresh->CopyFrom(message);
  message.GetReflection()->Swap(&message, fresh.get());
}

void MarkUnread(google::protobuf::Message& message) {
  message.GetReflection()->MutableUnknownFields(&message)->AddVarint(kMark, 0);
}

bool IsUnread(const google::protobuf::Message& message) {
  const auto& fields = message.GetReflection()->GetUnknownFields(message);
  return fields.field_count() > 0 && fields.field(fields.field_count() - 1).number() == kMark;
}

absl::Status UnreadableMessage(const google::protobuf::Message& message) {
  return BadStream(absl::StrCat("a message cannot be read as ", message.GetTypeName()));
}

absl::Status BrokenRead(const Limits& limits) {
  return absl::CancelledError(absl::StrCat("the client is gone, or sent a message of more than ",
                                           limits.received_message_bytes(), " bytes, which gRPC refuses"));
}

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
                absl::StrCat("the client has sent and taken next to nothing for ", absl::FormatDuration(patience)),
                {"CLIENT_STALLED", "", "", absl::FormatDuration(patience)}),
      absl::ZeroDuration());
}

// Does the same as TryCancel, with a status.
void CallCanceller::Cancel(const absl::Status& status) {
  const grpc::Status sent = ToGrpcStatus(status);
  const std::lock_guard lock(mu_);
  if (over_) return;
  grpc_call_cancel_with_status(context_.c_call(), static_cast<grpc_status_code>(sent.error_code()),
                               sent.error_message().c_str(), nullptr);
}

}  // namespace latvox
