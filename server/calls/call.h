// Functions for calls of all kinds.
#ifndef LATVOX_SERVER_CALLS_CALL_H_
#define LATVOX_SERVER_CALLS_CALL_H_

#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/status.h>

#include <mutex>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "server/base/limits.h"

namespace latvox {

// Returns RESOURCE_EXHAUSTED if the message is larger than the limit, without its outermost tag and length.
absl::Status CheckSize(const google::protobuf::Message& message, const Limits& limits);

// Drops fields that the protocol does not know. They take thirty times their bytes in memory.
void DropUnknownFields(google::protobuf::Message& message);

// gRPC reports a failed read in three cases: a half-close, a message that cannot be parsed, and a broken call, for
// example after a message larger than gRPC receives. A mark on the message before the read shows the second case,
// because parsing removes the mark. The third case is certain in OnDone, where gRPC has cancelled the call.
void MarkUnread(google::protobuf::Message& message);
bool IsUnread(const google::protobuf::Message& message);

// Returns INVALID_ARGUMENT for a message that cannot be parsed.
absl::Status UnreadableMessage(const google::protobuf::Message& message);

// The status in the log for a broken call whose client seemed to have sent too little.
absl::Status BrokenRead(const Limits& limits);

// Returns the status as it is sent. Call it before an error is sent: it tells clients that retry by themselves when to
// retry, or that a retry is pointless (-1).
grpc::Status StatusForClient(const absl::Status& status, grpc::CallbackServerContext& context);

// Returns the reason why gRPC has cancelled the call.
absl::Status CancellationOf(const grpc::CallbackServerContext& context);

// The status of a call whose client has neither sent nor taken anything for `patience`.
absl::Status StalledClient(absl::Duration patience);

// Cancels a call from a thread that does not know whether the call is over. Do not use it on gRPC's threads.
class CallCanceller {
 public:
  explicit CallCanceller(grpc::CallbackServerContext& context) : context_(context) {}
  // The client gets code and message once it has taken the messages written before, but no details.
  void Cancel(const absl::Status& status);
  // Call it at the beginning of OnDone; afterwards the context is gone.
  void Over() {
    const std::lock_guard lock(mu_);
    over_ = true;
  }

 private:
  grpc::CallbackServerContext& context_;
  std::mutex mu_;
  bool over_ = false;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_CALL_H_
