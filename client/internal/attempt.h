// One try of one call. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_ATTEMPT_H_
#define LATVOX_CLIENT_INTERNAL_ATTEMPT_H_

#include <grpcpp/client_context.h>
#include <grpcpp/support/status.h>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "latvox/call_options.h"
#include "latvox/credentials.h"

namespace latvox::client {

absl::Status CancelledByCaller();

// The end of a try, and whether another one can end better.
struct AttemptEnd {
  enum class Retry { kNever, kElsewhere, kLater };

  absl::Status status;
  Retry retry = Retry::kNever;                 // kElsewhere: on other servers only. kLater: on all
  absl::Duration wait = absl::ZeroDuration();  // the least wait that the server asked for
};

// The context of one try, under the call's deadline and cancellation.
class Attempt {
 public:
  // `options` must outlive it.
  Attempt(const CallOptions& options, const Credentials& credentials);

  grpc::ClientContext& context() { return context_; }

  // Returns the meaning of the call's end. Call it once the call is over.
  AttemptEnd End(const grpc::Status& status) const;

 private:
  const CallOptions& options_;
  grpc::ClientContext context_;
  const Cancellation::Subscription on_cancel_;  // destroyed before the context
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_ATTEMPT_H_
