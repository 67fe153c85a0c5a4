// A set of voxels that rays are cast at.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_SCENE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_SCENE_H_

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "client/tool/output/cell_index.h"
#include "client/tool/output/mask_step.h"
#include "latvox/for_each_voxel.h"
#include "latvox/types.h"

namespace latvox::client {

// The voxels' exact Voronoi cells, polyhedra and not the cubes of lattice coordinates.
//
//   cell          coordinates of a voxel in the scene: (ijk >> shift) - (those of the scene's corner)
//   scene frame   positions: world positions, scaled to cells of volume 1, relative to cell 0
//
// With a shift, each block of 2^shift lattice points per axis that holds a voxel is one cell of a lattice that is
// coarser by this factor. So details too small to see take no memory. Memory: 64 bytes for each 8^3 cells that are not
// empty, 2.2 KiB for each 64^3. Colors take 4 bytes for each cell and 40 for each 8^3. Adding is not thread-safe;
// everything else is.
class VoxelScene {
 public:
  class Beam;  // rays: client/tool/output/beam.h

  struct Hit {
    double t;
    Vec3i cell;
    int facet;  // index in facets() of the one that the ray enters by
  };

  struct Facet {
    Vec3i step;                      // to the neighbor behind it
    Vec3d normal;                    // unit length, outward
    double distance;                 // from the cell's center
    std::array<double, 3> gradient;  // of normal * (position of a cell) by the cell's coordinates
  };

  VoxelScene(const GridTransform& grid, int shift);

  // Adds the voxels of a brick, in any order and also repeatedly. The scene is less than 2^20 cells long.
  //   colors   of the brick's voxels, in lexicographic order of ijk: see client/tool/output/voxel_colors.h; or empty
  //            for all bricks. A cell of several voxels has the color of one of them, the same in any order of bricks.
  void Add(const Brick& brick, std::span<const uint32_t> colors = {});

  // Call it after the last Add. Computes the distance of empty bricks from voxels, so that rays can skip empty space,
  // and which bricks are outer ones.
  void Seal();

  bool Has(const Vec3i& cell) const;
  bool colored() const { return !colors_.empty(); }
  uint32_t ColorOf(const Vec3i& cell) const;  // precondition: colored(), Has(cell)
  Vec3d CenterOf(const Vec3i& cell) const;
  const std::vector<Facet>& facets() const { return facets_; }
  double cell_size() const { return size_; }  // edge of a cube with the volume of a cell, in world units
  bool empty() const { return masks_.empty(); }
  const std::vector<Vec3d>& cell_corners() const { return corners_; }  // relative to its center

  // Calls visit(brick) as ForEachBrick, except for bricks deep inside: full ones that full ones surround. Every line
  // that meets a cell meets its first and last cell outside of these. Precondition: Seal().
  template <class Visit>
  void ForEachOuterBrick(const Visit& visit) const {
    for (const auto& [tile_ijk, number] : tile_numbers_) VisitBricks(tile_ijk, number, outer_[number], visit);
  }

  // Returns the cells of a brick that have a facet without a cell behind it. Every line that meets a cell meets its
  // first and last point of all cells in one of these. The reason: the cells around any point are connected by facets.
  // If a facet's step is too long for MaskStep, returns all cells.
  Brick ShellOf(const Brick& brick) const;

  // Calls visit(brick) for every 8 x 8 x 8 block with a cell. The voxels of the brick are cells.
  template <class Visit>
  void ForEachBrick(const Visit& visit) const {
    for (const auto& [tile_ijk, number] : tile_numbers_) VisitBricks(tile_ijk, number, Occupied(tiles_[number]), visit);
  }

 private:
  static constexpr int kBricks = 512;  // in a tile
  using Mask = decltype(Brick::mask);
  using Tile = std::array<int32_t, kBricks>;  // index in masks_; -d: empty, as are all bricks less than d away

  // Calls visit(brick) for each of these bricks of a tile; none is empty.
  template <class Visit>
  void VisitBricks(const Vec3i& tile_ijk, size_t number, const Mask& bricks, const Visit& visit) const {
    const Tile& tile = tiles_[number];
    ForEachVoxel({tile_ijk, bricks}, [&](const Vec3i& brick_ijk) {
      visit(Brick{brick_ijk, masks_[static_cast<size_t>(tile[BrickInTile(brick_ijk)])]});
    });
  }

  static Mask Occupied(const Tile& tile);  // its bricks that are not empty
  Mask Full(const Tile& tile) const;
  size_t Touch(const Vec3i& brick_ijk);            // returns its index in masks_
  int32_t NumberOf(const Vec3i& brick_ijk) const;  // index in masks_; below 0: empty
  void Paint(const Brick& brick, std::span<const uint32_t> colors, const Vec3i& first, const Mask& before,
             size_t number);

  const int shift_;
  Basis basis_;      // scene frame
  Basis dual_;       // of basis_
  double size_ = 1;  // world
  std::vector<Vec3d> corners_;
  std::vector<Facet> facets_;
  std::vector<Facet> sides_;  // one of each two opposite facets
  Vec3d reach_{};             // extent of a cell from its point, in lattice coordinates
  std::optional<Vec3i> corner_;
  Vec3i low_{}, high_{};                        // cells; corners of the bricks, half-open
  std::optional<std::vector<MaskStep>> steps_;  // over each facet; absent: one is too long
  absl::flat_hash_map<Vec3i, size_t> tile_numbers_;
  std::vector<Tile> tiles_;
  std::vector<Mask> outer_;  // bricks of each tile
  std::vector<Mask> masks_;
  std::vector<std::vector<uint32_t>> colors_;  // of the cells of each mask, in order; the upper 8 bits are the rank
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VOXEL_SCENE_H_
