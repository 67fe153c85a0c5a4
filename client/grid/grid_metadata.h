// The metadata of our grids, of all types, without OpenVDB. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_GRID_METADATA_H_
#define LATVOX_CLIENT_GRID_GRID_METADATA_H_

#include "client/grid/metadata.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns the metadata about a grid's transform.
Metadata PlaceMetadata(const GridTransform& transform);

// Returns the certificate as metadata.
Metadata CertificateMetadata(const Certificate& certificate);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_GRID_METADATA_H_
