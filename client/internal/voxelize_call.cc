#include "client/internal/voxelize_call.h"

#include <utility>

#include "client/internal/result_warnings.h"
#include "client/internal/voxelize_stream.h"
#include "client/internal/wire.h"

namespace latvox::client {

VoxelizeCall::VoxelizeCall(Connection& connection, const VoxelizeRequest& request, const MeshId& mesh,
                           std::optional<std::string_view> drc, const VoxelizeHandlers& handlers,
                           const CallOptions& options)
    : connection_(connection),
      request_(request),
      mesh_(mesh),
      drc_(drc),
      handlers_(handlers),
      options_(options),
      check_(handlers, mesh.bytes, request_),
      tries_(connection, options, drc ? nullptr : &mesh) {}

absl::StatusOr<Summary> VoxelizeCall::Run() {
  if (options_.cancellation.cancelled()) return CancelledByCaller();
  for (;;) {
    const AttemptEnd end = TryServer();
    // A connection that breaks after the summary loses nothing.
    if (end.status.ok() || (end.retry == AttemptEnd::Retry::kLater && check_.End().ok())) break;
    broken_by_ = end.status;
    if (absl::Status status = tries_.Again(end); !status.ok()) return status;
  }
  absl::StatusOr<Summary> summary = check_.End();
  if (summary.ok()) {
    summary->resumed = resumed_;
    summary->bytes_sent = bytes_sent_;
    summary->bytes_received = bytes_received_;
    summary->warnings = WarningsOf(request_, check_.accepted_facts(), *summary);
  }
  return summary;
}

AttemptEnd VoxelizeCall::TryServer() {
  const bool ask_first = check_.accepted() || connection_.MayHave(tries_.server(), mesh_);
  AttemptEnd end = Stretch(/*with_mesh=*/drc_ && !ask_first);
  if (failed_here_ || end.status.code() != absl::StatusCode::kNotFound) return end;
  connection_.Forget(tries_.server(), mesh_);
  if (drc_) return ask_first ? Stretch(/*with_mesh=*/true) : end;
  end.retry = AttemptEnd::Retry::kElsewhere;
  return end;
}

AttemptEnd VoxelizeCall::Stretch(bool with_mesh) {
  check_.BeginStretch();
  v1::VoxelizeRequest first;
  *first.mutable_spec() = ToProto(request_, mesh_, check_.resume_after());
  Attempt attempt(options_, connection_.credentials());
  VoxelizeStream stream(*connection_.endpoint(tries_.server()).stub, attempt.context(), first,
                        with_mesh ? *drc_ : std::string_view());
  absl::Status ours;
  for (v1::VoxelizeResponse answer; stream.Read(answer);) {
    bytes_received_ += answer.ByteSizeLong();
    if (ours = Receive(answer); !ours.ok()) {
      attempt.context().TryCancel();
      break;
    }
  }
  const grpc::Status status = stream.Finish();
  bytes_sent_ += stream.sent();
  failed_here_ = !ours.ok();
  return failed_here_ ? AttemptEnd{ours} : attempt.End(status);
}

absl::Status VoxelizeCall::Receive(const v1::VoxelizeResponse& answer) {
  const bool going_on = check_.accepted();
  const std::optional<Vec3i> before = check_.resume_after();
  if (absl::Status status = check_.Receive(answer); !status.ok()) return status;
  if (answer.has_accepted()) connection_.Remember(tries_.server(), mesh_);
  if (check_.resume_after() != before || !going_on) tries_.Progress();
  return answer.has_accepted() && going_on ? TellOfResumption() : absl::OkStatus();
}

absl::Status VoxelizeCall::TellOfResumption() {
  ++resumed_;
  if (!handlers_.on_resumed) return absl::OkStatus();
  return handlers_.on_resumed({check_.resume_after(), connection_.endpoint(tries_.server()).address, broken_by_});
}

}  // namespace latvox::client
