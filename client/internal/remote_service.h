// The service of servers over gRPC. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_REMOTE_SERVICE_H_
#define LATVOX_CLIENT_INTERNAL_REMOTE_SERVICE_H_

#include <memory>

#include "client/internal/connection.h"
#include "latvox/voxel_service.h"

namespace latvox::client {

// Retries, resumes and checks, as Client promises. Threads: any threads may call all methods at once.
class RemoteService final : public VoxelService {
 public:
  explicit RemoteService(std::unique_ptr<Connection> connection);

  absl::StatusOr<Summary> Voxelize(const VoxelizeRequest& request, const MeshInput& mesh,
                                   const VoxelizeHandlers& handlers, const CallOptions& options) override;
  absl::Status PutMesh(const MeshId& mesh, std::string_view mesh_bytes, const CallOptions& options) override;
  absl::StatusOr<Pixelization> Pixelize(const PixelizeRequest& request, const CallOptions& options) override;
  absl::StatusOr<Limits> GetLimits(const CallOptions& options) override;
  absl::StatusOr<bool> Health(const CallOptions& options) override;

 private:
  const std::unique_ptr<Connection> connection_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_REMOTE_SERVICE_H_
