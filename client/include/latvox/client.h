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
// Three styles of the same call: VoxelizeAll gathers all bricks, Voxelize hands them to a function as they come, Stream
// gives a handle to take them from. The last two need the memory of some batches, however many bricks there are.
//
// A connection that breaks, a server that dies or drains, or is full for the moment, is no error as long as another try
// can help (latvox/retry_policy.h): the call goes on after the last complete tile, on another connection
// or another server, and whoever takes the bricks notices nothing but time.
//
// Errors everywhere: absl::Status with the codes that latvox/error.h lists; GetErrorDetails there tells
// field, value and limit. Nothing throws, nothing logs.
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
#include "latvox/types.h"
#include "latvox/voxel_service.h"
#include "latvox/voxelize_handlers.h"

namespace latvox::client {

// Connections to one server, or to several that serve the same. Threads: all methods may be called at once from any
// threads; calls share the connections, each of which carries any number. Ownership: movable, not copied; must outlive
// its calls, but not its streams. Costs: making one connects; keeping one for many calls is what saves that, and
// uploads.
class LATVOX_EXPORT Client {
 public:
  // Connects to "HOST:PORT" or "unix:PATH", or to several of these with commas between them. Calls take turns over
  // the servers that can be reached: those listed, and all that a HOST resolves to. One at least must be reachable now.
  // Errors: UNAVAILABLE at once if every server refuses the connection; INVALID_ARGUMENT, DEADLINE_EXCEEDED, CANCELLED.
  static absl::StatusOr<Client> Connect(const std::string& addresses, const CallOptions& options = {},
                                        const ConnectionOptions& connection_options = {});
  // The same, one address each.
  static absl::StatusOr<Client> Connect(const std::vector<std::string>& addresses, const CallOptions& options = {},
                                        const ConnectionOptions& connection_options = {});

  // A client of something else, not null: see latvox/voxel_service.h.
  explicit Client(std::shared_ptr<VoxelService> service);

  Client(Client&&) noexcept;             // the other one may then be destroyed or assigned to, no more
  Client& operator=(Client&&) noexcept;  // as if the one before were destroyed
  ~Client();                             // no call of it may be running

  // Voxelizes the Draco-encoded mesh and blocks until the last brick was handled. The mesh is read during the call and
  // uploaded while answers already arrive. Every answer is checked before it is handed on: sizes, order, no brick
  // twice or outside of Accepted.index_box, and in the end counts and digest. OK means that all voxels were handed on.
  // Bricks that were handed on before an error are correct as far as checked, but not all. Errors found before any
  // server is asked: INVALID_ARGUMENT for a mesh of no bytes, and for a request with both voxel_size and resolution.
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

  // Voxelizes likewise, and returns all at once. Memory: 80 bytes for each brick, twice that while it grows.
  absl::StatusOr<Voxelization> VoxelizeAll(const VoxelizeRequest& request, std::string_view mesh_drc,
                                           const CallOptions& options = {}) const;
  // The same without the bytes, as above.
  absl::StatusOr<Voxelization> VoxelizeAll(const VoxelizeRequest& request, const MeshId& mesh,
                                           const CallOptions& options = {}) const;

  // Begins to voxelize likewise, and returns at once; see latvox/brick_stream.h. The bytes are the
  // stream's: give them by std::move, or, to several streams, their MeshId.
  BrickStream Stream(VoxelizeRequest request, std::string mesh_drc, const CallOptions& options = {}) const;
  // The same without the bytes, as above.
  BrickStream Stream(VoxelizeRequest request, const MeshId& mesh, const CallOptions& options = {}) const;

  // Stores the mesh on one server, which later calls with it prefer. Idempotent. The mesh is not looked at before it is
  // used. Errors: INVALID_ARGUMENT for no bytes; RESOURCE_EXHAUSTED for one over Limits.max_mesh_bytes or
  // mesh_store_bytes.
  absl::StatusOr<MeshId> PutMesh(std::string_view mesh_drc, const CallOptions& options = {}) const;

  // Pixelizes polylines. The answer is checked before it is returned: the order of its pixels, and their digest.
  // Errors: INVALID_ARGUMENT also for both pixel_size and resolution.
  absl::StatusOr<Pixelization> Pixelize(const PixelizeRequest& request, const CallOptions& options = {}) const;

  // The limits of one server.
  absl::StatusOr<Limits> GetLimits(const CallOptions& options = {}) const;

  // Asks grpc.health.v1 of one server, once. True: the server takes requests. False: it answers, and takes none (it
  // drains, for example).
  absl::StatusOr<bool> Health(const CallOptions& options = {}) const;

 private:
  std::shared_ptr<VoxelService> service_;
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_CLIENT_H_
