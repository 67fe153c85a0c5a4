// The interface between a Client and servers. Tests of programs may put something else in their place.
//
//   class FullServer final : public latvox::client::VoxelService {
//     absl::StatusOr<Summary> Voxelize(const VoxelizeRequest&, const MeshInput&, const VoxelizeHandlers&,
//                                      const CallOptions&) override {
//       return absl::ResourceExhaustedError("jobs 16 exceeds 16");
//     }
//   };
//   const latvox::client::Client client(std::make_shared<FullServer>());
//
// client/examples/fake_server.cc is a complete test of this kind.
#ifndef LATVOX_LATVOX_VOXEL_SERVICE_H_
#define LATVOX_LATVOX_VOXEL_SERVICE_H_

#include <optional>
#include <string_view>

#include "absl/status/statusor.h"
#include "latvox/call_options.h"
#include "latvox/export.h"
#include "latvox/mesh_id.h"
#include "latvox/plane_types.h"
#include "latvox/types.h"
#include "latvox/voxelize_handlers.h"

namespace latvox::client {

// The mesh of one call.
struct MeshInput {
  MeshId id;                            // names it to servers that store it
  std::optional<std::string_view> drc;  // its bytes, valid during the call; absent: a server must have it
};

// One virtual method for each RPC, in plain values. A stand-in overrides the methods that its test needs; the others
// return UNIMPLEMENTED. The service of Client::Connect retries, resumes and checks every answer below this interface,
// and nothing above it does. So a stand-in returns exactly the results that the program under test sees.
//
// Threads: a Client calls from its callers' threads, concurrently if they do, and from the thread of a BrickStream.
class LATVOX_EXPORT VoxelService {
 public:
  VoxelService() = default;                               // for derived classes
  VoxelService(const VoxelService&) = delete;             // shared, not copied
  VoxelService& operator=(const VoxelService&) = delete;  // as above
  virtual ~VoxelService() = default;                      // destroyed with its last Client or BrickStream

  // As Client::Voxelize: the handlers run on the calling thread, on_accepted first. Returns their errors.
  virtual absl::StatusOr<Summary> Voxelize(const VoxelizeRequest& request, const MeshInput& mesh,
                                           const VoxelizeHandlers& handlers, const CallOptions& options);

  // As Client::PutMesh; `mesh` is the id of the bytes.
  virtual absl::Status PutMesh(const MeshId& mesh, std::string_view mesh_bytes, const CallOptions& options);

  // As Client::Pixelize.
  virtual absl::StatusOr<Pixelization> Pixelize(const PixelizeRequest& request, const CallOptions& options);

  // As Client::GetLimits.
  virtual absl::StatusOr<Limits> GetLimits(const CallOptions& options);

  // As Client::Health.
  virtual absl::StatusOr<bool> Health(const CallOptions& options);
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_VOXEL_SERVICE_H_
