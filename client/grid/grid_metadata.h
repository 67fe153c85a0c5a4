// The metadata of our grids, of all types. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_GRID_METADATA_H_
#define LATVOX_CLIENT_GRID_GRID_METADATA_H_

#include <string>

#include "client/grid/openvdb_trees.h"
#include "latvox/types.h"

namespace latvox::client {

// Throws openvdb::ArithmeticError where CheckGridTransform returns an error.
openvdb::math::Transform::Ptr MakeTransform(const GridTransform& transform);

// Returns the value as text for people. Numbers have as many digits as they need to be exact.
std::string MetadataText(const openvdb::Metadata& metadata);

// Sets the grid's transform, and the metadata about it.
void Place(const GridTransform& transform, openvdb::GridBase& grid);

// Inserts the metadata, except a grid's name and class, which are metadata, too.
void InsertMetadata(const openvdb::MetaMap& metadata, openvdb::GridBase& grid);

// Writes the certificate as metadata.
void Describe(const Certificate& certificate, openvdb::GridBase& grid);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_GRID_METADATA_H_
