// Joins the parts of a voxelization. Programs need no OpenVDB header for this.
#ifndef LATVOX_LATVOX_GRID_MERGE_H_
#define LATVOX_LATVOX_GRID_MERGE_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/cancellation.h"
#include "latvox/export.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {

// Facts about the whole that was written.
struct MergedGrid {
  uint64_t voxels = 0;         // of the whole
  uint64_t bricks = 0;         // of the whole
  uint64_t shared_bricks = 0;  // bricks of the parts beyond those of the whole: they are in more than one part
  std::string digest;          // of the whole
};

// Reads a part with fields. ReadGridContent is one such function.
using ReadPart = std::function<absl::StatusOr<GridContent>(const std::string& path)>;

// Writes the .vdb file of the whole to `path`, replacing an existing file; not atomic. The parts are .vdb and .nvdb
// files that `latvox voxelize` wrote for one mesh and request with --region, --bounds or --shard. The whole is the
// union of their voxels, with the metadata that they share. The digests are computed anew; they are the sums of the
// parts' digests where no brick is in two parts. Fields are joined, too: where parts share a voxel, they must agree on
// its values. A signed band is a level set again if its parts are all shards.
//
// Memory for sets without fields: 64 KiB for each part, 1 MiB for the whole, and 8 KiB for each block of 4096^3 voxels
// that the whole meets (300 MB at most). It does not depend on the number of bricks. The parts are read three times.
// Parts with fields are in memory all together: the bytes of their values, and 108 bytes for each brick. The whole is
// as large again, and then come its grids: see FieldGrids, DistanceGrid. All parts are kept open: one file each.
//
//   progress   if not empty, is called now and then, from any thread, one call at a time: the share of the work done, 0
//              to 1, and a third of the bricks read in three passes
//   read       reads parts with fields; empty: ReadGridContent
//
// Damaged parts are errors. MergeParts checks all digests, and all lengths in parts without fields. `read` must check
// the lengths in parts with fields, and ReadGridContent trusts them.
//
// Errors:
//   NOT_FOUND            there is no such file; the message names it
//   INVALID_ARGUMENT     a file is not a whole .vdb or .nvdb file of latvox, is compressed, or is given twice
//                        a file does not belong to one whole with the others; the message has field and values
//                        shards are missing
//   RESOURCE_EXHAUSTED   too many open files; memory
//   UNKNOWN              `path` cannot be written
//   CANCELLED            by `cancellation`
LATVOX_EXPORT absl::StatusOr<MergedGrid> MergeParts(const std::vector<std::string>& parts, const std::string& path,
                                                    const Cancellation& cancellation,
                                                    const std::function<void(double, uint64_t)>& progress,
                                                    const ReadPart& read = {});

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_GRID_MERGE_H_
