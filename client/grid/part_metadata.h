// Compares the metadata of parts with each other. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_PART_METADATA_H_
#define LATVOX_CLIENT_GRID_PART_METADATA_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/grid/openvdb_trees.h"
#include "client/grid/part_file.h"

namespace latvox::client {

// The facts that all parts share.
struct CommonFacts {
  openvdb::MetaMap metadata;  // of the whole, without its digest
  bool shards = false;        // the parts are all shards of one whole: no brick is in two of them
};

// Parts belong to one whole if their transforms and all their metadata are the same, except for
//
//   latvox_digest, latvox_part_digest, ...    each part has its own
//   latvox_shard                              "I/N": all N must be there, once
//   latvox_tunnel_free, latvox_minimal        true for the whole if true for each part
//   latvox_region, latvox_bounds              those of all parts, "; " between them, unless one part has none;
//                                             shards must have the same
//   latvox_request                            that of the whole if it is the same in all parts
//   latvox_whole_minimal                      the same in all; it refers to the whole that shards make
//   latvox_verified                           true only for a single part: nobody counted on the union
//   file_*                                    OpenVDB's statistics, which it writes anew
//
// Errors: INVALID_ARGUMENT naming file, field and both values; a part that is given twice; shards that are missing.
absl::StatusOr<CommonFacts> JoinMetadata(const std::vector<std::unique_ptr<PartFile>>& parts);

// Returns INVALID_ARGUMENT: two shards hold the same brick.
absl::Status SharedBrick(const std::string& path, const std::string& other, const Vec3i& brick_ijk);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_PART_METADATA_H_
