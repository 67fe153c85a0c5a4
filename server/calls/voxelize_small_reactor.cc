#include "server/calls/voxelize_small_reactor.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

// Precondition: the error is of a limit that only this call has.
absl::Status WithAdvice(const absl::Status& status) {
  if (status.ok()) return status;
  return MakeError(status.code(), absl::StrCat(status.message(), "; UploadMesh and VoxelizeStored have no such limit"),
                   *CauseOf(status));
}

}  // namespace

VoxelizeSmallReactor::VoxelizeSmallReactor(grpc::CallbackServerContext& context, v1::VoxelizeSmallRequest& request,
                                           v1::VoxelizeSmallResponse& response, CallOrigin origin,
                                           const CallEnvironment& environment)
    : CallReactor(context, std::move(origin), environment),
      request_(request),
      response_(response),
      memory_(environment.memory, environment.client) {}

absl::Status VoxelizeSmallReactor::Check() const { return WithAdvice(CheckSize(request_, environment_.limits)); }

void VoxelizeSmallReactor::Start() {
  absl::Status status = TakeSpec(request_.spec());
  if (status.ok() && !request_.mesh().empty()) status = TakePiece(std::move(*request_.mutable_mesh()));
  if (status.ok()) status = CheckUpload();
  status.ok() ? AwaitFirstTurn() : End(status);
}

// The fields of a response have the same numbers as those of one of its messages. So it has the bytes of all together.
void VoxelizeSmallReactor::Write(v1::VoxelizeResponse& message, bool /*more*/) {
  if (message.has_accepted()) *response_.mutable_accepted() = std::move(*message.mutable_accepted());
  if (message.has_bricks()) *response_.add_bricks() = std::move(*message.mutable_bricks());
  if (message.has_summary()) *response_.mutable_summary() = std::move(*message.mutable_summary());
  Written(true);
}

void VoxelizeSmallReactor::WriteLast(v1::VoxelizeResponse& message) {
  *response_.mutable_summary() = std::move(*message.mutable_summary());
  Finish(grpc::Status::OK);
}

absl::Status VoxelizeSmallReactor::AdmitAnswer(uint64_t bytes) {
  const uint64_t limit = environment_.limits.max_message_bytes;
  if (bytes <= limit) return memory_.Grow(bytes);
  return WithAdvice(LimitExceeded("answer_bytes", bytes, limit));
}

void VoxelizeSmallReactor::Describe(RequestRecord& record) const {
  VoxelCall::Describe(record);
  if (!record.status.ok()) record.bytes_out = 0;
}

}  // namespace latvox
