// The servers of a Client. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_CONNECTION_H_
#define LATVOX_CLIENT_INTERNAL_CONNECTION_H_

#include <grpcpp/channel.h>

#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/call_options.h"
#include "latvox/connection_options.h"
#include "latvox/mesh_id.h"
#include "latvox/v1/voxelizer.grpc.pb.h"

namespace latvox::client {

// One address, with a channel of its own. A list of names cannot be one channel of gRPC, and several channels show
// which server a call went to.
struct Endpoint {
  std::string address;
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<v1::Voxelizer::Stub> stub;
};

// Threads: all methods may be called at once.
class Connection {
 public:
  // As Client::Connect. `addresses`: at least one.
  static absl::StatusOr<std::unique_ptr<Connection>> Open(const std::vector<std::string>& addresses,
                                                          const CallOptions& options,
                                                          const ConnectionOptions& connection_options);

  size_t size() const { return endpoints_.size(); }
  const Credentials& credentials() const { return credentials_; }
  const Endpoint& endpoint(size_t index) const { return endpoints_[index]; }

  // Returns the endpoint for the next try, among those that are not `tried` (one bool for each). That is the next one
  // in turn that is connected, else one that may become so. With `mesh`, it prefers one that may have it. Returns
  // nothing if all are tried or known to be unreachable, but always one if none is tried.
  std::optional<size_t> Pick(const std::vector<bool>& tried, const MeshId* mesh);

  // The meshes that servers had when last asked. They may have dropped them since, so this is a guess.
  bool MayHave(size_t endpoint, const MeshId& mesh) const;
  void Remember(size_t endpoint, const MeshId& mesh);
  void Forget(size_t endpoint, const MeshId& mesh);

 private:
  struct Kept {
    size_t endpoint;
    std::array<uint8_t, 32> sha256;
    bool operator==(const Kept&) const = default;
  };

  Connection() = default;
  absl::Status AwaitReady(const std::vector<std::string>& addresses, const CallOptions& options) const;

  std::vector<Endpoint> endpoints_;
  Credentials credentials_;
  std::atomic<size_t> turn_ = 0;
  mutable std::mutex mutex_;
  std::deque<Kept> kept_;  // guarded by mutex_; the oldest comes first
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_CONNECTION_H_
