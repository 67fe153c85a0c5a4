// Grids that are made when they are written. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_LATE_GRIDS_H_
#define LATVOX_CLIENT_GRID_LATE_GRIDS_H_

#include <cstddef>
#include <functional>

#include "client/grid/openvdb_trees.h"

namespace latvox::client {

// Grids that a file has after others. Only one of them at a time is in memory.
struct LateGrids {
  size_t count = 0;
  std::function<openvdb::GridBase::Ptr(size_t n)> make = nullptr;  // returns the n-th one; throws std::bad_alloc
};

// Calls visit(grid) for each grid, in their order.
template <class Visit>
void ForEachGrid(const openvdb::GridCPtrVec& grids, const LateGrids& late, const Visit& visit) {
  for (const openvdb::GridBase::ConstPtr& grid : grids) visit(grid);
  for (size_t n = 0; n < late.count; ++n) visit(openvdb::GridBase::ConstPtr(late.make(n)));
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_LATE_GRIDS_H_
