// One stream of Voxelize. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_VOXELIZE_STREAM_H_
#define LATVOX_CLIENT_INTERNAL_VOXELIZE_STREAM_H_

#include <grpcpp/client_context.h>
#include <grpcpp/support/client_callback.h>

#include <condition_variable>
#include <mutex>
#include <string_view>

#include "absl/synchronization/notification.h"
#include "client/internal/mesh_pieces.h"
#include "latvox/v1/voxelizer.grpc.pb.h"

namespace latvox::client {

// Uploads on gRPC's threads while its own thread reads. So an early error shows while the upload still runs, and a
// server that answers before it has read everything cannot block both sides.
//
// It uses gRPC's callbacks, because only then do gRPC's threads watch the connection all the time. A synchronous stream
// is watched by the reading thread, and so not while a handler runs. Then pings get no answer for 5 s and more, and
// either end takes the other for dead.
class VoxelizeStream final : private grpc::ClientBidiReactor<v1::VoxelizeRequest, v1::VoxelizeResponse> {
 public:
  // Begins to send `first`, which has the spec, and the mesh. All must outlive the stream.
  VoxelizeStream(v1::Voxelizer::Stub& stub, grpc::ClientContext& context, const v1::VoxelizeRequest& first,
                 std::string_view mesh);
  // Cancels and finishes the stream, unless it is finished.
  ~VoxelizeStream() override;

  // Waits for the next answer. False: there is none; Finish has the reason.
  bool Read(v1::VoxelizeResponse& answer);

  // Waits for the end. Call it after the last answer, or once the context is cancelled.
  grpc::Status Finish();

  // Bytes of messages sent. After Finish.
  uint64_t sent() const { return sent_; }

 private:
  void SendNext();
  void OnWriteDone(bool ok) override;
  void OnReadDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

  grpc::ClientContext& context_;
  // Used by the upload's callbacks, one at a time:
  const v1::VoxelizeRequest& first_;
  MeshPieces<v1::VoxelizeRequest> pieces_;
  uint64_t sending_ = 0, sent_ = 0;

  std::mutex mutex_;
  std::condition_variable read_;
  enum class ReadState { kPending, kDone, kFailed } read_state_ = ReadState::kPending;  // guarded by mutex_

  bool finished_ = false;
  grpc::Status status_;
  absl::Notification done_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_VOXELIZE_STREAM_H_
