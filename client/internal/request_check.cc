#include "client/internal/request_check.h"

#include <optional>
#include <string>

#include "absl/strings/str_cat.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

absl::Status Refused(const std::string& message, const ErrorDetails& details) {
  absl::Status status = absl::InvalidArgumentError(message);
  SetErrorDetails(details, status);
  return status;
}

absl::Status CheckSampling(const char* size_name, const std::optional<double>& size,
                           const std::optional<uint32_t>& resolution) {
  if (!size || !resolution) return absl::OkStatus();
  return Refused(absl::StrCat("resolution: ", *resolution, " not together with ", size_name, " ", *size),
                 {"BAD_SPEC", "resolution", absl::StrCat(*resolution), absl::StrCat("no ", size_name), std::nullopt});
}

}  // namespace

absl::Status CheckMesh(std::string_view mesh_bytes) {
  if (!mesh_bytes.empty()) return absl::OkStatus();
  return Refused("mesh_bytes: has 0 bytes; it is to be a Draco-encoded mesh",
                 {"BAD_MESH", "mesh_bytes", "0", "1 byte at least", std::nullopt});
}

absl::Status CheckRequest(const VoxelizeRequest& request) {
  return CheckSampling("voxel_size", request.voxel_size, request.resolution);
}

absl::Status CheckRequest(const PixelizeRequest& request) {
  return CheckSampling("pixel_size", request.pixel_size, request.resolution);
}

}  // namespace latvox::client
