// The grids of fields. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_FIELD_FORMS_H_
#define LATVOX_CLIENT_GRID_FIELD_FORMS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "client/grid/openvdb_trees.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns empty grids of the type and with the names that latvox/grid/field_grids.h states: one, or one for each label.
// None for a field of links: see client/grid/link_grids.h.
std::vector<openvdb::GridBase::Ptr> NewFieldGrids(Field field, const std::vector<uint32_t>& fraction_labels);

// Makes the bricks' voxels active, with these values. The grid is the n-th one of NewFieldGrids, or another one of the
// first one's type. Throws std::bad_alloc.
void FillFieldGrid(std::span<const Brick> bricks, const FieldValues& values, openvdb::GridBase& grid, size_t n = 0);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_FIELD_FORMS_H_
