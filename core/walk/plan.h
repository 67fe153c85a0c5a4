// A walk of a request, on a given lattice and mesh.
#ifndef LATVOX_CORE_WALK_PLAN_H_
#define LATVOX_CORE_WALK_PLAN_H_

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "core/band/plan.h"
#include "core/base/stop_signal.h"
#include "core/base/vec.h"
#include "core/lattice/grid.h"
#include "core/request/request.h"
#include "core/walk/growth.h"
#include "core/walk/packed_pieces.h"
#include "core/walk/steps.h"

namespace latvox {

struct WalkPlan {
  WalkSteps steps;
  std::optional<BandPlan> close;  // of half the width of holes that count as closed
  // With `close`: what reached points grow by. Walks of several labels share it, because it may have megabytes.
  std::shared_ptr<const Ball> ball = nullptr;
  bool from_seed = false;      // the set is what a walk from `start` reaches; otherwise what none from outside does
  bool allow_outside = false;  // a walk from the seed may get outside
  bool with_surface = false;   // the set has the surface's points, too
  std::optional<Vec3i> start;  // local, once the mesh is snapped: the seed, or the point whose leak is asked for
  Grid grid;                   // for messages and distances
  size_t most_packed_bytes = kMostPackedBytes;  // of the pieces of tiles; walks of several labels share them
};

// Returns, per axis, by how many voxels at most the points that a walk keeps out of surpass the mesh.
Vec3i ReachOf(const WalkPlan& walk);

// Returns the lattice point nearest to a world position, the lexicographically first of several, as doubles have it.
// Once stopped, it is meaningless. Errors, with value and limit: INVALID_ARGUMENT if the position lies beyond
// 2^kPositionBits, as for meshes.
//   field   for the message
absl::StatusOr<Vec3i> NearestPoint(const Grid& grid, const Vec3d& world, const std::string& field,
                                   StopSignal stop = {});

// The start is in global coordinates. Once stopped, the plan is meaningless. Errors: INVALID_ARGUMENT as NearestPoint,
// and as MakeBandPlan for half of `close`.
//   frames   of the request's separability
absl::StatusOr<WalkPlan> MakeWalkPlan(const WalkSet& walk, const Grid& grid, const std::vector<Frame>& frames,
                                      StopSignal stop);

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_PLAN_H_
