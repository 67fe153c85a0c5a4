// Rays through a scene.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_BEAM_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_BEAM_H_

#include <array>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "client/tool/output/voxel_scene.h"
#include "latvox/types.h"

namespace latvox::client {

// Casts parallel rays in the frame of the scene: from + t * along, 0 <= t <= reach. Finds the facts about the direction
// once. Not thread-safe, because it remembers the tile of the last ray.
class VoxelScene::Beam {
 public:
  Beam(const VoxelScene& scene, const Vec3d& along);  // unit length; the scene outlives the beam, and does not change

  // Returns the first cell along the ray. A cell that contains `from` counts, with t = 0.
  std::optional<Hit> Cast(const Vec3d& from, double reach = std::numeric_limits<double>::infinity());

 private:
  static constexpr int kMaxAhead = 7;  // facets that a ray can leave by: half of at most 14

  // A facet that rays may leave a cell by, at t = (distance + cell * gradient - from * normal) / along.
  struct Way {
    double along, distance;  // along: component of the direction; distance: from the cell's center
    Vec3d normal;
    std::array<double, 3> gradient;
    Vec3i step;
    std::array<double, kMaxAhead> delays;  // of all ways, by this step
  };

  // A facet that rays may enter a cell by.
  struct Entry {
    double along;
    int facet;
  };

  using Interval = std::pair<double, double>;

  Interval Within(const Vec3d& from, const Vec3d& low, const Vec3d& high) const;
  void Visit(const Vec3i& brick_ijk);
  double Leave(const Vec3d& from, double t) const;
  void Walk(const Vec3d& start, double end, double& t, Vec3i& cell) const;
  Vec3i Nearest(const Vec3d& point, Vec3i cell) const;
  Hit Meet(const Vec3d& from, const Vec3i& cell) const;

  const VoxelScene& scene_;
  const Vec3d along_, lattice_along_;  // scene frame, lattice coordinates
  Vec3d inverse_{};                    // of lattice_along_
  Vec3d low_{}, high_{};               // of all cells, lattice coordinates
  std::array<Way, kMaxAhead> ways_;
  std::array<Entry, kMaxAhead> entries_;
  size_t ahead_ = 0, behind_ = 0;  // numbers of both
  bool known_ = false;             // whether the rest is
  Vec3i brick_ijk_{}, tile_ijk_{};
  const Tile* tile_ = nullptr;  // null: it is empty
  const Mask* mask_ = nullptr;  // of the brick; null: it is in an empty block
  Vec3i corner_{};              // of the block, cells
  int side_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_BEAM_H_
