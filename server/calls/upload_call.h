// The part of a call that receives a mesh: a specification, then the mesh in pieces.
#ifndef LATVOX_SERVER_CALLS_UPLOAD_CALL_H_
#define LATVOX_SERVER_CALLS_UPLOAD_CALL_H_

#include <cstdint>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/base/errors.h"
#include "server/base/milliseconds.h"
#include "server/calls/mesh_call.h"

namespace latvox {

//   Reactor   gRPC's, with StartRead
//   Request   its message, with `spec` and `mesh_piece`
//   Base      MeshCall, or a class derived from it
template <class Reactor, class Request, class Base = MeshCall>
class UploadCall : public CallReactor<Reactor, Base> {
 public:
  void OnReadDone(bool ok) final {
    if (!ok) return FinishReading();
    const absl::StatusOr<bool> more = ReceiveRequest();
    if (!more.ok() || !*more) return this->End(more.status());
    const std::lock_guard lock(mu_);
    NoteProgress();
    if (!HasEnded()) Read();
  }

 protected:
  using CallReactor<Reactor, Base>::CallReactor;
  using CallState::context_, CallState::environment_, CallState::heard_of_client_, CallState::mu_;
  using MeshCall::upload_, MeshCall::bytes_in_;

  // Sets upload_. Returns whether more is to be read; otherwise the call ends, as a success.
  virtual absl::StatusOr<bool> ReceiveSpec(const decltype(std::declval<Request>().spec())& spec) = 0;
  // Appends to upload_, counts bytes_in_, and reserves memory.
  virtual absl::Status ReceivePiece(std::string&& piece) = 0;
  // Called under mu_. Returns whether a status is decided.
  virtual bool HasEnded() const = 0;

  void Start() final { Read(); }

  void Describe(RequestRecord& record) const override {
    if (sent_too_little_ && context_.IsCancelled()) record.status = BrokenRead(environment_.limits);
    Base::Describe(record);
  }

 private:
  // Under mu_. A trickle of bytes is no sign of life, because it would keep place and memory for ever.
  void NoteProgress() {
    constexpr double kLeastBytesPerMillisecond = 1;
    const double least = kLeastBytesPerMillisecond * MillisecondsSince(heard_of_client_);
    const uint64_t bytes = bytes_in_ - heard_bytes_;
    if (!request_.has_spec() && (bytes == 0 || static_cast<double>(bytes) < least)) return;
    heard_of_client_ = CallState::Clock::now();
    heard_bytes_ = bytes_in_;
  }

  void Read() {
    MarkUnread(request_);
    this->StartRead(&request_);
  }

  absl::StatusOr<bool> ReceiveRequest() {
    if (absl::Status status = CheckSize(request_, environment_.limits); !status.ok()) return status;
    DropUnknownFields(request_);
    switch (request_.part_case()) {
      case Request::kSpec:
        if (upload_) return BadStream("spec: a second one came; it is the first message, and exactly one");
        return ReceiveSpec(request_.spec());
      case Request::kMeshPiece: {
        if (!upload_) return BadStream("mesh_piece came before spec");
        absl::Status status = ReceivePiece(std::move(*request_.mutable_mesh_piece()));
        return status.ok() ? absl::StatusOr<bool>(true) : status;
      }
      case Request::PART_NOT_SET:
        break;
    }
    return BadStream("a message has neither spec nor mesh_piece");
  }

  // The client has half-closed, or the call is broken.
  void FinishReading() {
    if (context_.IsCancelled()) return this->End(CancellationOf(context_));
    if (!IsUnread(request_)) return this->End(UnreadableMessage(request_));
    const absl::Status status = upload_ ? this->CheckUpload() : BadStream("the stream ended before spec");
    if (status.ok()) return this->AwaitFirstTurn();
    sent_too_little_ = true;
    this->End(status);
  }

  // Used by the reading callback.
  Request request_;
  uint64_t heard_bytes_ = 0;  // at heard_of_client_
  bool sent_too_little_ = false;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_UPLOAD_CALL_H_
