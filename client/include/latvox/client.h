// The latvox SDK: voxelizes meshes, and pixelizes polylines, through a latvox server.
//
//   auto client = latvox::client::Client::Connect("127.0.0.1:50151");
//   if (!client.ok()) return client.status();
//   latvox::client::VoxelizeRequest request;
//   request.lattice = latvox::client::NamedLattice::kBcc;
//   request.resolution = 256;
//   auto all = client->VoxelizeAll(request, drc_bytes);
//   if (!all.ok()) return all.status();
//   for (const latvox::client::Brick& brick : all->bricks) Use(brick);
//
// Three styles of the same call: VoxelizeAll collects all bricks, Voxelize passes them to a function as they come, and
// Stream returns a handle to take them from. The last two need the memory of a few batches, however many bricks there
// are.
//
// A broken connection is no error while another try can help (latvox/retry_policy.h), and neither is a server that
// dies, drains or is temporarily full. The call goes on after the last complete tile, on another connection or another
// server. The program notices only the time.
//
// All errors are absl::Status with the codes in latvox/error.h. GetErrorDetails there returns field, value and limit.
// Nothing throws, and nothing logs.
#ifndef LATVOX_LATVOX_CLIENT_H_
#define LATVOX_LATVOX_CLIENT_H_

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/brick_stream.h"
#include "latvox/call_options.h"
#include "latvox/connection_options.h"
#include "latvox/export.h"
#include "latvox/mesh_id.h"
#include "latvox/plane_types.h"
#include "latvox/private_server_options.h"
#include "latvox/types.h"
#include "latvox/voxel_service.h"
#include "latvox/voxelize_handlers.h"

namespace latvox::client {

// Connections to one server, or to several equal ones. Threads: any threads may call all methods at once. Calls share
// the connections, and each connection carries any number of calls. Ownership: movable, not copied; it must outlive its
// calls, but not its streams. Costs: its construction connects. Keep one for many calls, to save connections and
// uploads.
class LATVOX_EXPORT Client {
 public:
  // Connects to "HOST:PORT" or "unix:PATH", or to several of these with commas between them. Calls take turns over all
  // reachable servers: those in the list, and all addresses of a HOST. At least one must be reachable now. Errors:
  // UNAVAILABLE at once if every server refuses the connection; INVALID_ARGUMENT, DEADLINE_EXCEEDED, CANCELLED.
  static absl::StatusOr<Client> Connect(const std::string& addresses, const CallOptions& options = {},
                                        const ConnectionOptions& connection_options = {});
  // Does the same, with one address in each text.
  static absl::StatusOr<Client> Connect(const std::vector<std::string>& addresses, const CallOptions& options = {},
                                        const ConnectionOptions& connection_options = {});

  // Starts a server for this program alone, and connects to it. The server is another process. It ends with the last
  // Client or BrickStream of this call, and by itself if this process ends without destructors, however that happens.
  // It listens on a Unix socket that only this user can open, and takes half of the memory of an ordinary server,
  // because the program needs the rest. It ignores variables that are meant for other servers: LATVOX_CONFIG,
  // addresses, TLS and tokens. Its warnings go to standard error. Costs: about 50 ms. Nobody can connect to the server
  // again, so a call that loses it ends with UNAVAILABLE. Errors: UNAVAILABLE with the program's name (not found, ended
  // early, does not serve within 20 s); DEADLINE_EXCEEDED, CANCELLED.
  static absl::StatusOr<Client> StartPrivate(const PrivateServerOptions& server_options = {},
                                             const CallOptions& options = {});

  // Makes a client of another service than a server, for tests: see latvox/voxel_service.h. Precondition: not null.
  explicit Client(std::shared_ptr<VoxelService> service);

  Client(Client&&) noexcept;             // the other one may then only be destroyed or assigned to
  Client& operator=(Client&&) noexcept;  // replaces this one
  ~Client();                             // Precondition: none of its calls runs

  // Voxelizes the mesh, and blocks until the last brick was handled. `mesh_bytes` are a Draco stream, or the arrays
  // that VoxelizeRequest::raw_mesh describes. Answers arrive while the mesh is still uploaded. Every answer is checked
  // before it is passed on: sizes, order, no brick twice or outside of Accepted.index_box, and at the end counts and
  // digest. OK means that all voxels were passed on. Bricks passed on before an error are correct as far as they were
  // checked, but incomplete. Errors found without a server: INVALID_ARGUMENT for an empty mesh, and for a request with
  // both voxel_size and resolution.
  //
  // Servers store meshes. So many calls with one mesh upload it once to each server, as long as the server keeps it.
  // This Client remembers which mesh it sent where, and sends the mesh's SHA-256 instead. It sends the mesh again if
  // the server asks for it.
  absl::StatusOr<Summary> Voxelize(const VoxelizeRequest& request, std::string_view mesh_bytes,
                                   const VoxelizeHandlers& handlers, const CallOptions& options = {}) const;

  // Does the same without the bytes. NOT_FOUND if no reachable server has the mesh. A server may drop it at any time,
  // starts without it, and has only meshes that were sent to it. A program that still has the bytes should pass them.
  absl::StatusOr<Summary> Voxelize(const VoxelizeRequest& request, const MeshId& mesh, const VoxelizeHandlers& handlers,
                                   const CallOptions& options = {}) const;

  // Voxelizes the mesh in the same way, and returns everything at once. Memory: 80 bytes for each brick, twice that
  // while it grows.
  absl::StatusOr<Voxelization> VoxelizeAll(const VoxelizeRequest& request, std::string_view mesh_bytes,
                                           const CallOptions& options = {}) const;
  // Does the same without the bytes, as above.
  absl::StatusOr<Voxelization> VoxelizeAll(const VoxelizeRequest& request, const MeshId& mesh,
                                           const CallOptions& options = {}) const;

  // Begins to voxelize in the same way, and returns at once; see latvox/brick_stream.h. The stream owns the bytes: pass
  // them by std::move, or, to several streams, their MeshId.
  BrickStream Stream(VoxelizeRequest request, std::string mesh_bytes, const CallOptions& options = {}) const;
  // Does the same without the bytes, as above.
  BrickStream Stream(VoxelizeRequest request, const MeshId& mesh, const CallOptions& options = {}) const;

  // Stores the mesh on one server, which later calls with it prefer. Idempotent. The server does not decode the mesh
  // before its first use. Errors: INVALID_ARGUMENT for an empty mesh; RESOURCE_EXHAUSTED for one over
  // Limits.max_mesh_bytes or mesh_store_bytes.
  absl::StatusOr<MeshId> PutMesh(std::string_view mesh_bytes, const CallOptions& options = {}) const;

  // Pixelizes polylines. The answer is checked before it is returned: the order of its pixels, and their digest.
  // Errors: INVALID_ARGUMENT also for both pixel_size and resolution.
  absl::StatusOr<Pixelization> Pixelize(const PixelizeRequest& request, const CallOptions& options = {}) const;

  // Returns the limits of one server.
  absl::StatusOr<Limits> GetLimits(const CallOptions& options = {}) const;

  // Asks grpc.health.v1 of one server, once. True: the server takes requests. False: it answers, but takes none (it
  // drains, for example).
  absl::StatusOr<bool> Health(const CallOptions& options = {}) const;

 private:
  std::shared_ptr<VoxelService> service_;
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_CLIENT_H_
