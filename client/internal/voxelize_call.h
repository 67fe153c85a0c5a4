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

// One call, which may take several streams. Each but the first asks for what comes after the last tile that was handed
// on; so the stretches together are the one stream that an undisturbed call has, as the stream is a function of the
// request.
//
// The mesh travels with the first stream to a server. Later ones only name it, if this Client has seen that the server
// has it, or if a stream is resumed: a question that costs a round trip, for an answer that may save the upload. A
// server that says NOT_FOUND is sent the mesh.
class VoxelizeCall {
 public:
  // `drc`: the mesh's bytes; without them, the server must have the mesh. All must outlive the call.
  VoxelizeCall(Connection& connection, const VoxelizeRequest& request, const MeshId& mesh,
               std::optional<std::string_view> drc, const VoxelizeHandlers& handlers, const CallOptions& options);

  // Once. As Client::Voxelize.
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
  bool failed_here_ = false;  // the last stretch, for a handler or the check, not the server
  Tries tries_;
  absl::Status broken_by_;  // how the last stream ended
  int resumed_ = 0;
  uint64_t bytes_sent_ = 0, bytes_received_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_VOXELIZE_CALL_H_
