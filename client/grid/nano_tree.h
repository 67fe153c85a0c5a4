// The bricks of a .nvdb file. Includes NanoVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_NANO_TREE_H_
#define LATVOX_CLIENT_GRID_NANO_TREE_H_

#include <istream>
#include <memory>

#include "client/grid/nano_frame.h"
#include "client/grid/part_tree.h"

namespace latvox::client {

// Reads where the nodes of a grid of bool lie, in the tree's order. Throws std::runtime_error: they do not lie within
// it; std::ios_base::failure. Precondition: the grid is not compressed.
std::unique_ptr<PartTree> NewNanoTree(std::istream& in, const NanoFrameGrid& grid);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_NANO_TREE_H_
