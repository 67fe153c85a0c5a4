// Voxels that rays are cast at.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_SCENE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_SCENE_H_

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "client/tool/output/voxel_walk.h"
#include "latvox/types.h"

namespace latvox::client {

// A line of sight in the frame of a scene: from + t * along, 0 <= t <= reach.
struct Ray {
  Vec3d from, along;  // along: unit length
  double reach = std::numeric_limits<double>::infinity();
};

// The voxels' Voronoi cells, exactly: polyhedra, not the cubes of lattice coordinates.
//
//   cell        a voxel's coordinates in the scene: (ijk >> shift) - (that of the scene's corner)
//   scene frame positions: the world's, scaled to cells of volume 1, about cell 0
//
// With a shift, each 2^shift lattice points on every axis, of which one is a voxel, are one cell of the lattice that is
// as much coarser: what is too small to be seen need not be kept. Memory: 64 bytes for 8^3 cells that are not empty, 2
// KiB for 64^3; of colors, 4 bytes for each cell and 40 for 8^3. Adding is not thread-safe; everything else is.
class VoxelScene {
 public:
  struct Hit {
    double t;
    Vec3i cell;
    int facet;  // that the ray comes in by, of facets()
  };

  struct Facet {
    Vec3i step;                      // to the neighbour behind it
    Vec3d normal;                    // unit length, outwards
    double distance;                 // from the cell's centre
    std::array<double, 3> gradient;  // of normal * (position of a cell), for each of the cell's coordinates
  };

  VoxelScene(const GridTransform& grid, int shift);

  // In any order; what is there already is no error. The scene is less than 2^20 cells long.
  //   colors   of the brick's voxels, in lexicographic order of ijk: see client/tool/output/voxel_colors.h; or none,
  //   for all
  //            bricks. A cell of several voxels has the color of one of them, the same in whatever order they come.
  void Add(const Brick& brick, std::span<const uint32_t> colors = {});

  // After the last Add: finds how far the next voxels are from what is empty, for rays to pass over it faster.
  void Seal();

  // The first cell along the ray. One that the ray begins in counts, with t = 0.
  std::optional<Hit> Cast(const Ray& ray) const;

  bool Has(const Vec3i& cell) const;
  bool colored() const { return !colors_.empty(); }
  uint32_t ColorOf(const Vec3i& cell) const;  // precondition: colored(), Has(cell)
  Vec3d CenterOf(const Vec3i& cell) const;
  const std::vector<Facet>& facets() const { return facets_; }
  double cell_size() const { return size_; }  // of a cell of volume 1, in world units
  bool empty() const { return masks_.empty(); }
  const std::vector<Vec3d>& cell_corners() const { return corners_; }  // relative to its centre

  // Calls visit(cell) for every cell, in no particular order, but for those deep inside, of bricks that are full among
  // bricks that are full: every line that meets a cell meets its last one, and its first, outside of these.
  template <class Visit>
  void ForEachOuter(const Visit& visit) const {
    ForEachBrick([&](const Brick& brick) {
      if (!IsDeep(brick.brick_ijk)) ForEachVoxel(brick, visit);
    });
  }

  // Calls visit(brick) for every 8 x 8 x 8 cells of which one is there; the brick's voxels are cells.
  template <class Visit>
  void ForEachBrick(const Visit& visit) const {
    for (const auto& [tile_ijk, number] : tile_numbers_) {
      for (int n = 0; n < kBricks; ++n) {
        const int32_t mask = tiles_[static_cast<size_t>(number)][static_cast<size_t>(n)];
        if (mask < 0) continue;
        const Vec3i brick_ijk = {tile_ijk[0] * 8 + (n >> 6), tile_ijk[1] * 8 + (n >> 3 & 7), tile_ijk[2] * 8 + (n & 7)};
        visit(Brick{brick_ijk, masks_[static_cast<size_t>(mask)]});
      }
    }
  }

 private:
  static constexpr int kBricks = 512;  // of a tile
  using Mask = decltype(Brick::mask);
  using Tile = std::array<int32_t, kBricks>;  // into masks_; -d: bricks that are less than d away are empty, too
  class Walk;

  size_t Touch(const Vec3i& brick_ijk);            // its number in masks_
  int32_t NumberOf(const Vec3i& brick_ijk) const;  // in masks_; below 0: it is empty
  bool IsDeep(const Vec3i& brick_ijk) const;
  void Paint(const Brick& brick, std::span<const uint32_t> colors, const Vec3i& first, const Mask& before,
             size_t number);
  Vec3i Nearest(const Vec3d& point, Vec3i cell) const;  // from a cell near by
  Hit Meet(const Ray& ray, const Vec3i& cell) const;

  const int shift_;
  Basis basis_;      // scene frame
  Basis dual_;       // of basis_
  double size_ = 1;  // world
  std::vector<Vec3d> corners_;
  std::vector<Facet> facets_;
  std::vector<Facet> sides_;  // one of each two that are opposite
  Vec3d reach_{};             // of a cell, in lattice coordinates
  std::optional<Vec3i> corner_;
  Vec3i low_{}, high_{};  // cells; corners of the bricks, half-open
  absl::flat_hash_map<Vec3i, int32_t> tile_numbers_;
  std::vector<Tile> tiles_;
  std::vector<Mask> masks_;
  std::vector<std::vector<uint32_t>> colors_;  // of the cells of each mask, in their order; above them, 8 bits of rank
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_SCENE_H_
