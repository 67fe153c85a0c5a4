// What a Client talks to: servers, or, in the tests of programs that use one, whatever stands in for them.
//
//   class FullServer final : public latvox::client::VoxelService {
//     absl::StatusOr<Summary> Voxelize(const VoxelizeRequest&, const MeshInput&, const VoxelizeHandlers&,
//                                      const CallOptions&) override {
//       return absl::ResourceExhaustedError("jobs 16 exceeds 16");
//     }
//   };
//   const latvox::client::Client client(std::make_shared<FullServer>());
//
// client/examples/fake_server.cc is such a test, whole.
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
  MeshId id;                            // names it to servers that keep it
  std::optional<std::string_view> drc;  // its bytes, valid during the call; absent: a server has to have it
};

// One virtual method for each rpc, in plain values. A stand-in overrides those that its test needs; the others are
// UNIMPLEMENTED. What Client::Connect makes retries, resumes and checks every answer below this interface, and nothing
// above it does: a stand-in says what the program under test is to see, no more.
//
// Threads: a Client calls from the threads that call it, at once if they do, and from that of a BrickStream.
class LATVOX_EXPORT VoxelService {
 public:
  VoxelService() = default;                               // for those derived
  VoxelService(const VoxelService&) = delete;             // shared, not copied
  VoxelService& operator=(const VoxelService&) = delete;  // as above
  virtual ~VoxelService() = default;                      // with its last Client or BrickStream

  // As Client::Voxelize: the handlers run on the calling thread, on_accepted first; what they return is returned.
  virtual absl::StatusOr<Summary> Voxelize(const VoxelizeRequest& request, const MeshInput& mesh,
                                           const VoxelizeHandlers& handlers, const CallOptions& options);

  // As Client::PutMesh; `mesh` is the id of the bytes.
  virtual absl::Status PutMesh(const MeshId& mesh, std::string_view mesh_drc, const CallOptions& options);

  // As Client::Pixelize.
  virtual absl::StatusOr<Pixelization> Pixelize(const PixelizeRequest& request, const CallOptions& options);

  // As Client::GetLimits.
  virtual absl::StatusOr<Limits> GetLimits(const CallOptions& options);

  // As Client::Health.
  virtual absl::StatusOr<bool> Health(const CallOptions& options);
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_VOXEL_SERVICE_H_
