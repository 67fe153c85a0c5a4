#include "server/calls/voxelize_reactor.h"

#include "server/base/errors.h"

namespace latvox {

void VoxelizeStoredReactor::Start() {
  absl::Status status = TakeSpec(request_.spec());
  if (status.ok() && request_.spec().mesh_sha256().empty()) {
    status = BadSpec("mesh_sha256 is not set: a stored mesh has no other name", "mesh_sha256", "");
  }
  status.ok() ? AwaitFirstTurn() : End(status);
}

}  // namespace latvox
