// Metadata and transform of our grids in OpenVDB's grids. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_OPENVDB_METADATA_H_
#define LATVOX_CLIENT_GRID_OPENVDB_METADATA_H_

#include <string>

#include "client/grid/metadata.h"
#include "client/grid/openvdb_trees.h"
#include "latvox/types.h"

namespace latvox::client {

// Throws std::runtime_error where CheckGridTransform returns an error.
openvdb::math::Transform::Ptr MakeTransform(const GridTransform& transform);

// Returns the value as text for people. Numbers have as many digits as they need to be exact.
std::string MetadataText(const openvdb::Metadata& metadata);

// Sets the grid's transform, and the metadata about it.
void Place(const GridTransform& transform, openvdb::GridBase& grid);

// Returns the value as OpenVDB's. Throws exceptions of OpenVDB: it has no such type.
openvdb::Metadata::Ptr ToOpenVdb(const MetadataValue& value);

void InsertMetadata(const Metadata& metadata, openvdb::GridBase& grid);

// Inserts the metadata, except a grid's name and class, which are metadata, too.
void InsertMetadata(const openvdb::MetaMap& metadata, openvdb::GridBase& grid);

// Returns all metadata.
Metadata MetadataOf(const openvdb::MetaMap& metadata);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_OPENVDB_METADATA_H_
