// A call that is over before it begins.
#ifndef LATVOX_SERVER_CALLS_FAILED_CALL_H_
#define LATVOX_SERVER_CALLS_FAILED_CALL_H_

#include <grpcpp/support/server_callback.h>
#include <grpcpp/support/status.h>

namespace latvox {

// `Reactor` is one of gRPC's server reactors. The object owns itself.
template <class Reactor>
class FailedCall final : public Reactor {
 public:
  explicit FailedCall(const grpc::Status& status) { this->Finish(status); }
  void OnCancel() override {}
  void OnDone() override { delete this; }
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_FAILED_CALL_H_
