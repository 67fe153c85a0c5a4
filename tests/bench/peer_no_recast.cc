// Stands in for peer_recast.cc where latvox was configured without Recast.
#include "tests/bench/peer.h"

namespace latvox {

absl::StatusOr<std::unique_ptr<Peer>> RecastPeer(const TriangleMesh& /*mesh*/, const Bounds& /*bounds*/,
                                                 double /*voxel_size*/) {
  return absl::UnimplementedError(
      "--peer recast: this program was built without Recast; install Debian's librecast-dev, then run cmake and build");
}

}  // namespace latvox
