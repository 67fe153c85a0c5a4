// Voxelize, from the first try to the last brick. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_VOXELIZE_CALL_H_
#define LATVOX_CLIENT_INTERNAL_VOXELIZE_CALL_H_

#include <optional>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/internal/answer_check.h"
#include "client/internal/connection.h"
#include "client/internal/tries.h"
#include "latvox/types.h"
#include "latvox/voxelize_handlers.h"

namespace latvox::client {

// One call, which may take several streams. Each later stream asks for the bricks after the last tile that was passed
// on. So the stretches together equal the one stream of an undisturbed call, because the stream is a function of the
// request.
//
// The first stream to a server carries the mesh. Later ones only name it, if this Client has seen that the server has
// it, or if a stream is resumed. This may save the upload, and costs a round trip at worst: a server that answers
// NOT_FOUND gets the mesh.
class VoxelizeCall {
 public:
  // `drc`: the mesh's bytes; without them, the server must have the mesh. All must outlive the call.
  VoxelizeCall(Connection& connection, const VoxelizeRequest& request, const MeshId& mesh,
               std::optional<std::string_view> drc, const VoxelizeHandlers& handlers, const CallOptions& options);

  // Call it once. As Client::Voxelize.
  absl::StatusOr<Summary> Run();

 private:
  AttemptEnd TryServer();
  AttemptEnd Stretch(bool with_mesh);
  absl::Status Receive(const v1::VoxelizeResponse& answer);
  absl::Status TellOfResumption();

  Connection& connection_;
  const VoxelizeRequest& request_;
  const MeshId& mesh_;
  const std::optional<std::string_view> drc_;
  const VoxelizeHandlers& handlers_;
  const CallOptions& options_;
  AnswerCheck check_;
  bool failed_here_ = false;  // the last stretch failed because of a handler or the check, not the server
  Tries tries_;
  absl::Status broken_by_;  // the error of the last stream
  int resumed_ = 0;
  uint64_t bytes_sent_ = 0, bytes_received_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_VOXELIZE_CALL_H_
