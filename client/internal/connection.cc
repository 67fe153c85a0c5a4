#include "client/internal/connection.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/internal/attempt.h"
#include "client/internal/channel.h"
#include "client/internal/grpc_message.h"

namespace latvox::client {
namespace {

constexpr absl::Duration kConnectTimeout = absl::Seconds(10);
constexpr absl::Duration kCancellationPoll = absl::Milliseconds(20);
// The most meshes remembered for servers. Further ones are asked for again, which costs a round trip.
constexpr size_t kMeshesRemembered = 256;

bool IsOutOfReach(grpc_connectivity_state state) {
  return state == GRPC_CHANNEL_TRANSIENT_FAILURE || state == GRPC_CHANNEL_SHUTDOWN;
}

// Returns gRPC's reason, which exists only for a call: nobody listens there, or a certificate is not trusted. Empty if
// the server has come up by now.
std::string WhyOutOfReach(v1::Voxelizer::Stub& stub) {
  constexpr absl::Duration kPatience = absl::Seconds(1);
  grpc::ClientContext context;
  context.set_deadline(absl::ToChronoTime(absl::Now() + kPatience));
  v1::GetLimitsResponse limits;
  const grpc::Status status = stub.GetLimits(&context, {}, &limits);
  const bool answered = status.error_code() != grpc::StatusCode::UNAVAILABLE &&
                        status.error_code() != grpc::StatusCode::DEADLINE_EXCEEDED;
  return answered ? "" : ConnectionReason(status.error_message());
}

}  // namespace

absl::StatusOr<std::unique_ptr<Connection>> Connection::Open(const std::vector<std::string>& addresses,
                                                             const CallOptions& options,
                                                             const ConnectionOptions& connection_options) {
  std::unique_ptr<Connection> connection(new Connection);
  connection->credentials_ = connection_options.credentials;
  for (const std::string& address : addresses) {
    auto channel = MakeChannel(address, connection_options);
    if (!channel.ok()) return channel.status();
    auto stub = v1::Voxelizer::NewStub(*channel);
    connection->endpoints_.push_back({address, *std::move(channel), std::move(stub)});
  }
  if (absl::Status status = connection->AwaitReady(addresses, options); !status.ok()) return status;
  return connection;
}

absl::Status Connection::AwaitReady(const std::vector<std::string>& addresses, const CallOptions& options) const {
  const std::string names = absl::StrJoin(addresses, ", ");
  const absl::Time give_up = std::min(options.deadline.value_or(absl::InfiniteFuture()), absl::Now() + kConnectTimeout);
  for (;;) {
    const Endpoint* hope = nullptr;
    grpc_connectivity_state state = GRPC_CHANNEL_SHUTDOWN;
    for (const Endpoint& endpoint : endpoints_) {
      const grpc_connectivity_state its = endpoint.channel->GetState(/*try_to_connect=*/true);
      if (its == GRPC_CHANNEL_READY) return absl::OkStatus();
      if (IsOutOfReach(its)) continue;
      hope = &endpoint;
      state = its;
    }
    if (options.cancellation.cancelled()) return CancelledByCaller();
    if (hope == nullptr) {
      const std::string why = WhyOutOfReach(*endpoints_.front().stub);
      if (why.empty()) continue;
      return absl::UnavailableError(absl::StrCat("cannot reach the server at ", names, " (", why, ")"));
    }
    if (absl::Now() >= give_up) {
      if (options.deadline && give_up == *options.deadline) {
        return absl::DeadlineExceededError(absl::StrCat("the deadline passed while connecting to ", names));
      }
      return absl::UnavailableError(
          absl::StrCat("no answer from the server at ", names, " within ", absl::FormatDuration(kConnectTimeout)));
    }
    hope->channel->WaitForStateChange(state, absl::ToChronoTime(absl::Now() + kCancellationPoll));
  }
}

std::optional<size_t> Connection::Pick(const std::vector<bool>& tried, const MeshId* mesh) {
  const bool none_tried = std::find(tried.begin(), tried.end(), true) == tried.end();
  const size_t first = turn_++;
  std::optional<size_t> best;
  int best_rank = -1;
  for (size_t n = 0; n < size(); ++n) {
    const size_t index = (first + n) % size();
    if (tried[index]) continue;
    const grpc_connectivity_state state = endpoints_[index].channel->GetState(/*try_to_connect=*/true);
    if (IsOutOfReach(state) && !none_tried) continue;
    int rank = state == GRPC_CHANNEL_READY ? 2 : IsOutOfReach(state) ? 0 : 1;
    if (mesh != nullptr && rank > 0 && MayHave(index, *mesh)) rank += 2;
    if (rank <= best_rank) continue;
    best = index;
    best_rank = rank;
  }
  return best;
}

bool Connection::MayHave(size_t endpoint, const MeshId& mesh) const {
  const std::lock_guard lock(mutex_);
  return std::find(kept_.begin(), kept_.end(), Kept{endpoint, mesh.sha256}) != kept_.end();
}

void Connection::Remember(size_t endpoint, const MeshId& mesh) {
  const Kept kept{endpoint, mesh.sha256};
  const std::lock_guard lock(mutex_);
  if (std::find(kept_.begin(), kept_.end(), kept) != kept_.end()) return;
  if (kept_.size() >= kMeshesRemembered) kept_.pop_front();
  kept_.push_back(kept);
}

void Connection::Forget(size_t endpoint, const MeshId& mesh) {
  const std::lock_guard lock(mutex_);
  kept_.erase(std::remove(kept_.begin(), kept_.end(), Kept{endpoint, mesh.sha256}), kept_.end());
}

}  // namespace latvox::client
