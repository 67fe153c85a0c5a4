#include "client/internal/voxelize_stream.h"

#include <utility>

namespace latvox::client {

VoxelizeStream::VoxelizeStream(v1::Voxelizer::Stub& stub, grpc::ClientContext& context,
                               const v1::VoxelizeRequest& first, std::string_view mesh)
    : context_(context), first_(first), pieces_(mesh) {
  stub.async()->Voxelize(&context, this);
  AddHold();  // for the reads, which do not come from gRPC's callbacks
  SendNext();
  StartCall();
}

VoxelizeStream::~VoxelizeStream() {
  if (finished_) return;
  context_.TryCancel();
  Finish();
}

void VoxelizeStream::SendNext() {
  const v1::VoxelizeRequest& next = sending_ == 0 ? first_ : pieces_.Next();
  sending_ = next.ByteSizeLong();
  if (pieces_.empty()) {
    StartWriteLast(&next, grpc::WriteOptions());
  } else {
    StartWrite(&next);
  }
}

// A failed write means that the call is over.
void VoxelizeStream::OnWriteDone(bool ok) {
  if (!ok) return;
  sent_ += sending_;
  if (!pieces_.empty()) SendNext();
}

bool VoxelizeStream::Read(v1::VoxelizeResponse& answer) {
  StartRead(&answer);
  std::unique_lock lock(mutex_);
  read_.wait(lock, [this] { return read_state_ != ReadState::kPending; });
  return std::exchange(read_state_, ReadState::kPending) == ReadState::kDone;
}

void VoxelizeStream::OnReadDone(bool ok) {
  const std::lock_guard lock(mutex_);
  read_state_ = ok ? ReadState::kDone : ReadState::kFailed;
  read_.notify_one();
}

grpc::Status VoxelizeStream::Finish() {
  finished_ = true;
  RemoveHold();
  done_.WaitForNotification();
  return status_;
}

void VoxelizeStream::OnDone(const grpc::Status& status) {
  status_ = status;
  done_.Notify();
}

}  // namespace latvox::client
