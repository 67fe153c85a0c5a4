// What parts say of themselves, held against each other. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_PART_METADATA_H_
#define LATVOX_CLIENT_GRID_PART_METADATA_H_

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "client/grid/openvdb_trees.h"
#include "client/grid/part_file.h"

namespace latvox::client {

// What the parts have in common.
struct CommonFacts {
  openvdb::MetaMap metadata;  // of the whole but for its digest
  bool shards = false;        // they are all shards of one whole: no brick is in two of them
};

// Parts are of one whole if their transforms and all their metadata are the same, but for
//
//   latvox_digest                             which is each part's own
//   latvox_shard                              "I/N": all N must be there, once
//   latvox_tunnel_free, latvox_minimal        true of the whole if true of each part
//   latvox_region, latvox_bounds              those of all parts, "; " between them, unless one has none; shards' equal
//   latvox_request                            that of the whole if it is the same in all parts
//   latvox_whole_minimal                      the same in all; shards make the whole of which it speaks
//   latvox_verified                           true of a single part only: nobody counted on the union
//   file_*                                    OpenVDB's statistics, which it writes anew
//
// Errors: INVALID_ARGUMENT naming file, field and both values; a part that is given twice; shards that are missing.
absl::StatusOr<CommonFacts> JoinMetadata(const std::vector<std::unique_ptr<PartFile>>& parts);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_PART_METADATA_H_
