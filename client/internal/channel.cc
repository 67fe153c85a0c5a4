#include "client/internal/channel.h"

#include <grpc/grpc.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/support/channel_arguments.h>

#include "client/internal/channel_security.h"

namespace latvox::client {
namespace {

// Larger messages of a server are refused, so that a bad one cannot take all memory.
constexpr int kMaxReceiveBytes = 64 << 20;

// Waits before a broken connection is made again. gRPC's own 1 s to 120 s would make retries run out in vain.
constexpr absl::Duration kFirstReconnect = absl::Milliseconds(100), kSlowestReconnect = absl::Seconds(2);
// A server that has moved has another address; the default of 30 s keeps looking for it at the old one.
constexpr absl::Duration kResolveAgain = absl::Seconds(5);

int ToMilliseconds(absl::Duration duration) { return static_cast<int>(absl::ToInt64Milliseconds(duration)); }

grpc::ChannelArguments Arguments(const ConnectionOptions& options) {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxReceiveBytes);
  arguments.SetLoadBalancingPolicyName("round_robin");
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, ToMilliseconds(options.keepalive_time));
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, ToMilliseconds(options.keepalive_timeout));
  // Without this, no ping is sent after the second one on a connection without data to send, for example during a long
  // computation.
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, ToMilliseconds(kFirstReconnect));
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, ToMilliseconds(kSlowestReconnect));
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, ToMilliseconds(options.connect_timeout));
  arguments.SetInt(GRPC_ARG_DNS_MIN_TIME_BETWEEN_RESOLUTIONS_MS, ToMilliseconds(kResolveAgain));
  return arguments;
}

}  // namespace

absl::StatusOr<std::shared_ptr<grpc::Channel>> MakeChannel(const std::string& address,
                                                           const ConnectionOptions& options) {
  // gRPC's library stays up until the process ends. Its shutdown takes 10 s if an abandoned call still sends.
  [[maybe_unused]] static const bool kept_up = (grpc_init(), true);
  const auto credentials = MakeChannelCredentials(address, options.credentials);
  if (!credentials.ok()) return credentials.status();
  return grpc::CreateCustomChannel(address, *credentials, Arguments(options));
}

}  // namespace latvox::client
