#include "client/client.h"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/security/credentials.h>

#include <algorithm>
#include <chrono>
#include <future>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/answer_check.h"
#include "client/plane_wire.h"
#include "client/wire.h"
#include "latvox/v1/voxelizer.grpc.pb.h"

namespace latvox::client {
namespace {

constexpr size_t kPieceBytes = size_t{1} << 20;
// A server's message is refused above this, so that a bad one cannot take all memory.
constexpr int kMaxReceiveBytes = 64 << 20;
constexpr absl::Duration kConnectTimeout = absl::Seconds(10);
constexpr absl::Duration kCancellationPoll = absl::Milliseconds(20);

absl::Status CancelledByCaller() { return absl::CancelledError("cancelled by the caller"); }

void SetDeadline(const CallOptions& options, grpc::ClientContext& context) {
  if (options.deadline) context.set_deadline(absl::ToChronoTime(*options.deadline));
}

// gRPC's own words for the two ends that the caller brought about say less than these.
absl::Status Explain(const grpc::Status& status, const CallOptions& options) {
  if (status.ok()) return absl::OkStatus();
  if (options.cancellation.cancelled()) return CancelledByCaller();
  if (status.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED) {
    return absl::DeadlineExceededError("the deadline passed before the server was done");
  }
  return FromGrpc(status);
}

using Stream = grpc::ClientReaderWriterInterface<v1::VoxelizeRequest, v1::VoxelizeResponse>;

// Sends spec and mesh; returns the bytes of messages sent. A failed write means that the call is over; why, Finish
// tells.
uint64_t Upload(const VoxelizeRequest& request, std::string_view mesh, Stream& stream) {
  v1::VoxelizeRequest message;
  *message.mutable_spec() = ToProto(request, mesh.size());
  uint64_t sent = message.ByteSizeLong();
  if (!stream.Write(message)) return sent;
  for (size_t begin = 0; begin < mesh.size(); begin += kPieceBytes) {
    message.set_mesh_piece(std::string(mesh.substr(begin, kPieceBytes)));
    if (!stream.Write(message)) return sent;
    sent += message.ByteSizeLong();
  }
  stream.WritesDone();
  return sent;
}

}  // namespace

struct Client::Connection {
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<v1::Voxelizer::Stub> stub;
};

Client::Client(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;
Client::~Client() = default;

absl::StatusOr<Client> Client::Connect(const std::string& address, const CallOptions& options) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxReceiveBytes);
  auto channel = grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
  const absl::Time give_up = std::min(options.deadline.value_or(absl::InfiniteFuture()), absl::Now() + kConnectTimeout);
  for (;;) {
    const grpc_connectivity_state state = channel->GetState(/*try_to_connect=*/true);
    if (state == GRPC_CHANNEL_READY) break;
    if (options.cancellation.cancelled()) return CancelledByCaller();
    if (state == GRPC_CHANNEL_TRANSIENT_FAILURE || state == GRPC_CHANNEL_SHUTDOWN) {
      return absl::UnavailableError(absl::StrCat("cannot reach the server at ", address));
    }
    if (absl::Now() >= give_up) {
      if (options.deadline && give_up == *options.deadline) {
        return absl::DeadlineExceededError(absl::StrCat("the deadline passed while connecting to ", address));
      }
      return absl::UnavailableError(
          absl::StrCat("no answer from the server at ", address, " within ", absl::FormatDuration(kConnectTimeout)));
    }
    channel->WaitForStateChange(state, absl::ToChronoTime(absl::Now() + kCancellationPoll));
  }
  auto connection = std::make_unique<Connection>();
  connection->stub = v1::Voxelizer::NewStub(channel);
  connection->channel = std::move(channel);
  return Client(std::move(connection));
}

// One thread writes and the calling thread reads, so that an early error is seen while the upload still runs, and a
// server that answers before it has read everything cannot block both sides.
absl::StatusOr<Summary> Client::Voxelize(const VoxelizeRequest& request, std::string_view mesh_drc,
                                         const VoxelizeHandlers& handlers, const CallOptions& options) const {
  if (options.cancellation.cancelled()) return CancelledByCaller();
  grpc::ClientContext context;
  SetDeadline(options, context);
  const Cancellation::Subscription on_cancel(options.cancellation, [&context] { context.TryCancel(); });
  const auto stream = connection_->stub->Voxelize(&context);

  std::future<uint64_t> upload;
  try {
    upload = std::async(std::launch::async, [&] { return Upload(request, mesh_drc, *stream); });
  } catch (const std::system_error& error) {
    context.TryCancel();
    stream->Finish();
    return absl::ResourceExhaustedError(absl::StrCat("no thread for the upload: ", error.what()));
  }
  AnswerCheck check(handlers, mesh_drc.size());
  absl::Status ours;
  uint64_t received = 0;
  for (v1::VoxelizeResponse answer; stream->Read(&answer);) {
    received += answer.ByteSizeLong();
    if (ours = check.Take(answer); !ours.ok()) {
      context.TryCancel();
      break;
    }
  }
  // Without this, an answer that ended early would leave the writer waiting for a server that does not read.
  const uint64_t sent = upload.get();
  const grpc::Status status = stream->Finish();
  if (!ours.ok()) return ours;
  if (absl::Status theirs = Explain(status, options); !theirs.ok()) return theirs;
  absl::StatusOr<Summary> summary = check.End();
  if (summary.ok()) {
    summary->bytes_sent = sent;
    summary->bytes_received = received;
  }
  return summary;
}

absl::StatusOr<Pixelization> Client::Pixelize(const PixelizeRequest& request, const CallOptions& options) const {
  grpc::ClientContext context;
  SetDeadline(options, context);
  const Cancellation::Subscription on_cancel(options.cancellation, [&context] { context.TryCancel(); });
  const v1::PixelizeRequest message = ToProto(request);
  v1::PixelizeResponse response;
  const grpc::Status status = connection_->stub->Pixelize(&context, message, &response);
  if (absl::Status error = Explain(status, options); !error.ok()) return error;
  absl::StatusOr<Pixelization> pixelization = FromProto(response);
  if (pixelization.ok()) {
    pixelization->bytes_sent = message.ByteSizeLong();
    pixelization->bytes_received = response.ByteSizeLong();
  }
  return pixelization;
}

absl::StatusOr<Limits> Client::GetLimits(const CallOptions& options) const {
  grpc::ClientContext context;
  SetDeadline(options, context);
  const Cancellation::Subscription on_cancel(options.cancellation, [&context] { context.TryCancel(); });
  v1::GetLimitsResponse response;
  const grpc::Status status = connection_->stub->GetLimits(&context, v1::GetLimitsRequest(), &response);
  if (absl::Status error = Explain(status, options); !error.ok()) return error;
  return FromProto(response);
}

// grpc.health.v1 written out by hand, as two bytes at most are spoken: the request {} asks for the whole server, and
// the answer's field 1 is the status, 1 for SERVING.
absl::StatusOr<bool> Client::Health(const CallOptions& options) const {
  grpc::ClientContext context;
  SetDeadline(options, context);
  const Cancellation::Subscription on_cancel(options.cancellation, [&context] { context.TryCancel(); });
  const grpc::Slice nothing;
  const grpc::ByteBuffer request(&nothing, 1);
  grpc::ByteBuffer response;
  std::promise<grpc::Status> done;
  grpc::GenericStub(connection_->channel)
      .UnaryCall(&context, "/grpc.health.v1.Health/Check", grpc::StubOptions(), &request, &response,
                 [&done](grpc::Status status) { done.set_value(std::move(status)); });
  if (absl::Status error = Explain(done.get_future().get(), options); !error.ok()) return error;
  grpc::Slice slice;
  if (!response.DumpToSingleSlice(&slice).ok()) return absl::DataLossError("the health answer cannot be read");
  const std::string_view bytes(reinterpret_cast<const char*>(slice.begin()), slice.size());
  return bytes == std::string_view("\x08\x01", 2);
}

}  // namespace latvox::client
