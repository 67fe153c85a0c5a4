// What our grids say of themselves, whatever their type. Costs OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_GRID_METADATA_H_
#define LATVOX_CLIENT_GRID_GRID_METADATA_H_

#include <string>

#include "client/grid/openvdb_trees.h"
#include "latvox/types.h"

namespace latvox::client {

// Throws openvdb::ArithmeticError for what CheckGridTransform refuses.
openvdb::math::Transform::Ptr MakeTransform(const GridTransform& transform);

// As people read it. Numbers have all digits that tell them from others.
std::string MetadataText(const openvdb::Metadata& metadata);

// The grid's transform, and the metadata of it.
void Place(const GridTransform& transform, openvdb::GridBase& grid);

// The metadata of the certificate.
void Describe(const Certificate& certificate, openvdb::GridBase& grid);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_GRID_METADATA_H_
