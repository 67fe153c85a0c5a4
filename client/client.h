// The latvox SDK: voxelizes meshes, and pixelizes polylines, through a latvox server.
//
//   auto client = latvox::client::Client::Connect("127.0.0.1:50151");
//   if (!client.ok()) return client.status();
//   latvox::client::VoxelizeRequest request;
//   request.lattice = latvox::client::NamedLattice::kBcc;
//   request.resolution = 256;
//   auto summary = client->Voxelize(request, drc_bytes, {.on_bricks = [&](const latvox::client::BrickBatch& batch) {
//     for (const auto& brick : batch.bricks) Use(brick);
//     return absl::OkStatus();
//   }});
//
// Errors everywhere: absl::Status with the codes of the protocol (INVALID_ARGUMENT: the request or the mesh is wrong;
// RESOURCE_EXHAUSTED: a limit, or the server is full; UNAVAILABLE: it cannot be reached, or went away;
// DEADLINE_EXCEEDED, CANCELLED; INTERNAL: a defect of the server) and DATA_LOSS: the server broke the protocol.
// GetErrorDetails in client/error.h tells field, value and limit. Nothing throws, nothing logs.
#ifndef LATVOX_CLIENT_CLIENT_H_
#define LATVOX_CLIENT_CLIENT_H_

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cancellation.h"
#include "client/plane_types.h"
#include "client/types.h"

namespace latvox::client {

struct CallOptions {
  std::optional<absl::Time> deadline;  // DEADLINE_EXCEEDED after it; default: none
  Cancellation cancellation;           // CANCELLED soon after its Cancel()
};

// Both run on the thread that called Voxelize, one at a time. Anything but OK ends the call, and Voxelize returns it:
// absl::CancelledError() is the plain way to stop. Empty functions are skipped.
struct VoxelizeHandlers {
  std::function<absl::Status(const Accepted&)> on_accepted = {};  // once, first
  std::function<absl::Status(const BrickBatch&)> on_bricks = {};  // while it runs, the server is held back
};

// One connection to one server. Threads: all methods may be called at once from any threads; calls share the
// connection. Movable; must outlive its calls.
class Client {
 public:
  // Connects to "HOST:PORT" or "unix:PATH", in plain text.
  // Errors: UNAVAILABLE at once if the server refuses the connection; DEADLINE_EXCEEDED, CANCELLED.
  static absl::StatusOr<Client> Connect(const std::string& address, const CallOptions& options = {});

  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;
  ~Client();

  // Voxelizes the Draco-encoded mesh and blocks until the last brick was handled. The mesh is read during the call and
  // uploaded while answers already arrive. Every answer is checked before it is handed on: sizes, order, no brick
  // twice or outside of Accepted.index_box, and in the end counts and digest. OK means that all voxels were handed on.
  // Bricks that were handed on before an error are correct as far as checked, but not all.
  absl::StatusOr<Summary> Voxelize(const VoxelizeRequest& request, std::string_view mesh_drc,
                                   const VoxelizeHandlers& handlers, const CallOptions& options = {}) const;

  // Pixelizes polylines. The answer is checked before it is returned: the order of its pixels, and their digest.
  absl::StatusOr<Pixelization> Pixelize(const PixelizeRequest& request, const CallOptions& options = {}) const;

  absl::StatusOr<Limits> GetLimits(const CallOptions& options = {}) const;

  // Asks grpc.health.v1. True: the server takes requests. False: it answers, and takes none (it drains, for example).
  absl::StatusOr<bool> Health(const CallOptions& options = {}) const;

 private:
  struct Connection;
  explicit Client(std::unique_ptr<Connection> connection);

  std::unique_ptr<Connection> connection_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_CLIENT_H_
