#include "latvox/voxel_service.h"

#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

absl::Status NotOffered(absl::string_view method) {
  return absl::UnimplementedError(absl::StrCat("this VoxelService does not offer ", method));
}

}  // namespace

absl::StatusOr<Summary> VoxelService::Voxelize(const VoxelizeRequest&, const MeshInput&, const VoxelizeHandlers&,
                                               const CallOptions&) {
  return NotOffered("Voxelize");
}

absl::Status VoxelService::PutMesh(const MeshId&, std::string_view, const CallOptions&) {
  return NotOffered("PutMesh");
}

absl::StatusOr<Pixelization> VoxelService::Pixelize(const PixelizeRequest&, const CallOptions&) {
  return NotOffered("Pixelize");
}

absl::StatusOr<Limits> VoxelService::GetLimits(const CallOptions&) { return NotOffered("GetLimits"); }

absl::StatusOr<bool> VoxelService::Health(const CallOptions&) { return NotOffered("Health"); }

}  // namespace latvox::client
