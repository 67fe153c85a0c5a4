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
// A connection that breaks, a server that dies or drains, or is full for the moment, is no error as long as another try
// can help (client/retry_policy.h): Voxelize goes on after the last complete tile, on another connection or another
// server, and its handlers notice nothing but time.
//
// Errors everywhere: absl::Status with the codes that client/error.h lists; GetErrorDetails there tells field, value
// and limit. Nothing throws, nothing logs.
#ifndef LATVOX_CLIENT_CLIENT_H_
#define LATVOX_CLIENT_CLIENT_H_

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/call_options.h"
#include "client/connection_options.h"
#include "client/mesh_id.h"
#include "client/plane_types.h"
#include "client/types.h"

namespace latvox::client {

class Connection;

// A broken stream goes on.
struct Resumption {
  std::optional<Vec3i> after_tile;  // the last 64^3 tile handed on, lattice coordinates >> 6; absent: none was
  std::string address;              // of the server that goes on
  absl::Status cause;               // how the stream before ended
};

// They run on the thread that called Voxelize, one at a time. Anything but OK ends the call, and Voxelize returns it:
// absl::CancelledError() is the plain way to stop. Empty functions are skipped.
struct VoxelizeHandlers {
  std::function<absl::Status(const Accepted&)> on_accepted = {};  // once, first
  std::function<absl::Status(const BrickBatch&)> on_bricks = {};  // while it runs, the server is held back
  std::function<absl::Status(const Resumption&)> on_resumed = {};
};

// Connections to one server, or to several that serve the same. Threads: all methods may be called at once from any
// threads; calls share the connections. Movable; must outlive its calls.
class Client {
 public:
  // Connects to "HOST:PORT" or "unix:PATH", or to several of these with commas between them. Calls take turns over
  // the servers that can be reached: those listed, and all that a HOST resolves to. One at least must be reachable now.
  // Errors: UNAVAILABLE at once if every server refuses the connection; INVALID_ARGUMENT, DEADLINE_EXCEEDED, CANCELLED.
  static absl::StatusOr<Client> Connect(const std::string& addresses, const CallOptions& options = {},
                                        const ConnectionOptions& connection_options = {});
  static absl::StatusOr<Client> Connect(const std::vector<std::string>& addresses, const CallOptions& options = {},
                                        const ConnectionOptions& connection_options = {});

  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;
  ~Client();

  // Voxelizes the Draco-encoded mesh and blocks until the last brick was handled. The mesh is read during the call and
  // uploaded while answers already arrive. Every answer is checked before it is handed on: sizes, order, no brick
  // twice or outside of Accepted.index_box, and in the end counts and digest. OK means that all voxels were handed on.
  // Bricks that were handed on before an error are correct as far as checked, but not all.
  //
  // Servers keep meshes. So many calls with one mesh upload it once to each server, as long as that keeps it: this
  // Client remembers what it sent where, sends the mesh's SHA-256 instead, and the mesh again if the server asks for
  // it.
  absl::StatusOr<Summary> Voxelize(const VoxelizeRequest& request, std::string_view mesh_drc,
                                   const VoxelizeHandlers& handlers, const CallOptions& options = {}) const;

  // The same without the bytes. NOT_FOUND if no server that could be asked has the mesh: a server may drop it at any
  // time, starts without it, and has only what it was sent itself. Who still has the bytes, gives them.
  absl::StatusOr<Summary> Voxelize(const VoxelizeRequest& request, const MeshId& mesh, const VoxelizeHandlers& handlers,
                                   const CallOptions& options = {}) const;

  // Stores the mesh on one server, which later calls with it prefer. Idempotent. The mesh is not looked at before it is
  // used. Errors: RESOURCE_EXHAUSTED for one over Limits.max_mesh_bytes or mesh_store_bytes.
  absl::StatusOr<MeshId> PutMesh(std::string_view mesh_drc, const CallOptions& options = {}) const;

  // Pixelizes polylines. The answer is checked before it is returned: the order of its pixels, and their digest.
  absl::StatusOr<Pixelization> Pixelize(const PixelizeRequest& request, const CallOptions& options = {}) const;

  absl::StatusOr<Limits> GetLimits(const CallOptions& options = {}) const;

  // Asks grpc.health.v1 of one server, once. True: the server takes requests. False: it answers, and takes none (it
  // drains, for example).
  absl::StatusOr<bool> Health(const CallOptions& options = {}) const;

 private:
  explicit Client(std::unique_ptr<Connection> connection);

  std::unique_ptr<Connection> connection_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_CLIENT_H_
