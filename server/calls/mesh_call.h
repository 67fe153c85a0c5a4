// The state of a call that receives a mesh.
#ifndef LATVOX_SERVER_CALLS_MESH_CALL_H_
#define LATVOX_SERVER_CALLS_MESH_CALL_H_

#include <cstdint>
#include <optional>

#include "absl/status/status.h"
#include "server/calls/call_state.h"
#include "server/work/mesh_upload.h"

namespace latvox {

class MeshCall : public CallState {
 protected:
  using CallState::CallState;

  // Returns an error unless enough bytes have come. Precondition: the specification has come.
  virtual absl::Status CheckUpload() const { return upload_->CheckComplete(); }
  bool IsReading() const override { return reading_; }

  void Describe(RequestRecord& record) const override {
    record.bytes_in = bytes_in_;
    record.upload_ms = upload_ms_;
  }

  // The mesh has come: the call awaits its first turn.
  void AwaitFirstTurn() {
    {
      const std::lock_guard lock(mu_);
      reading_ = false;
      upload_ms_ = upload_->milliseconds();
      ready_ = Clock::now();
    }
    environment_.registry.AwaitTurn(this);
  }

  // The time when the call was ready for its first turn.
  Clock::time_point ready() const { return ready_; }

  // Used by the callback that receives, then by the task.
  std::optional<MeshUpload> upload_;
  uint64_t bytes_in_ = 0;

 private:
  Clock::time_point ready_;  // set before AwaitTurn, whose lock shows it to Work

  // Guarded by mu_.
  bool reading_ = true;
  std::optional<double> upload_ms_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_MESH_CALL_H_
