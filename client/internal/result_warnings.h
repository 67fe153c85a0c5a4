// Warnings about the result of a voxelization.
#ifndef LATVOX_CLIENT_INTERNAL_RESULT_WARNINGS_H_
#define LATVOX_CLIENT_INTERNAL_RESULT_WARNINGS_H_

#include <vector>

#include "latvox/types.h"
#include "latvox/warning.h"

namespace latvox::client {

// Returns what is probably not meant in a result:
//   EMPTY_RESULT   there is no voxel; the message gives the reason
//   EMPTY_SHARD    a shard has no voxel; this is only a note
//   LABEL_ENCLOSES_NOTHING   labels of an enclosed set cut no point off
//   FEW_VOXELS     the longest side of the mesh is below four voxel sizes, as happens when millimeters are taken for
//                  meters; not if the request states a resolution
std::vector<Warning> WarningsOf(const VoxelizeRequest& request, const Accepted& accepted, const Summary& summary);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_RESULT_WARNINGS_H_
