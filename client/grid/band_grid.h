// The grid of a band. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_BAND_GRID_H_
#define LATVOX_CLIENT_GRID_BAND_GRID_H_

#include "client/grid/openvdb_trees.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns an empty grid "distance" with this value beyond the band, in world units. See DistanceGrid for the arguments,
// and for the grids that are level sets.
openvdb::FloatGrid::Ptr NewBandGrid(const Basis& basis, double width, bool is_signed, bool whole);

// Makes the values inside of a level set negative. Throws exceptions of OpenVDB and std::bad_alloc.
void FillInside(openvdb::FloatGrid& grid);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_BAND_GRID_H_
