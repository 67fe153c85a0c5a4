// Values of bricks' voxels in grids. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_FILL_GRID_H_
#define LATVOX_CLIENT_GRID_FILL_GRID_H_

#include <bit>
#include <cstddef>
#include <span>

#include "client/grid/openvdb_trees.h"
#include "latvox/types.h"

namespace latvox::client {

// Makes the bricks' voxels active. A voxel's value is value(number). The numbers of consecutive voxels, in the order
// of BrickBatch, are `step` apart. A leaf's voxels have the order of a brick's bits. Throws std::bad_alloc.
template <class Grid, class Number, class Value>
void FillGrid(std::span<const Brick> bricks, const Number* number, size_t step, const Value& value, Grid& grid) {
  openvdb::tree::ValueAccessor<typename Grid::TreeType> tree(grid.tree());
  for (const Brick& brick : bricks) {
    auto& leaf = *tree.touchLeaf({brick.brick_ijk[0] * 8, brick.brick_ijk[1] * 8, brick.brick_ijk[2] * 8});
    for (openvdb::Index word = 0; word < 8; ++word) {
      for (uint64_t bits = brick.mask[word]; bits != 0; bits &= bits - 1, number += step) {
        leaf.setValueOn(word * 64 + static_cast<openvdb::Index>(std::countr_zero(bits)), value(number));
      }
    }
  }
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_FILL_GRID_H_
