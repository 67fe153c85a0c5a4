// What calls have in common.
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

// RESOURCE_EXHAUSTED if the message is larger than the limit, its outermost tag and length aside.
absl::Status CheckSize(const google::protobuf::Message& message, const Limits& limits);

// Leaves out what the protocol does not know, which takes thirty times its bytes in memory.
void DropUnknownFields(google::protobuf::Message& message);

// gRPC says the same, that a read failed, of a half-close, of a message that cannot be parsed, and of a call that is
// broken, be it by a message larger than what gRPC receives. A mark that is put on the message before the read tells
// the second: parsing takes it away. The third is known for certain in OnDone, where gRPC has cancelled the call.
void MarkUnread(google::protobuf::Message& message);
bool IsUnread(const google::protobuf::Message& message);

// INVALID_ARGUMENT for what cannot be parsed.
absl::Status UnreadableMessage(const google::protobuf::Message& message);

// For the log, of a call that is broken and whose client seemed to have sent too little.
absl::Status BrokenRead(const Limits& limits);

// The status as it is sent. For one that is not OK, before it is sent: a client that retries by itself is told when to,
// or (-1) that it is of no use.
grpc::Status StatusForClient(const absl::Status& status, grpc::CallbackServerContext& context);

// Why gRPC has cancelled the call.
absl::Status CancellationOf(const grpc::CallbackServerContext& context);

// Why a call ends whose client has neither sent nor taken anything for `patience`.
absl::Status StalledClient(absl::Duration patience);

// Cancels a call from a thread that does not know whether it is over. Not on gRPC's threads.
class CallCanceller {
 public:
  explicit CallCanceller(grpc::CallbackServerContext& context) : context_(context) {}
  // The client gets code and message once it has taken what was written; details it gets none.
  void Cancel(const absl::Status& status);
  // At the beginning of OnDone, after which the context is gone.
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
