// The grids of fields. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_FIELD_FORMS_H_
#define LATVOX_CLIENT_GRID_FIELD_FORMS_H_

#include <span>

#include "client/grid/openvdb_trees.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns an empty grid of the type that latvox/grid/field_grids.h states, with the field's name.
openvdb::GridBase::Ptr NewFieldGrid(Field field);

// Makes the bricks' voxels active, with these values. The grid is one of NewFieldGrid. Throws std::bad_alloc.
void FillFieldGrid(std::span<const Brick> bricks, const FieldValues& values, openvdb::GridBase& grid);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_FIELD_FORMS_H_
