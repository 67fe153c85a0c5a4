// Joins the voxels of parts with their fields. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_CONTENT_JOIN_H_
#define LATVOX_CLIENT_GRID_CONTENT_JOIN_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/grid/grid_content.h"
#include "latvox/types.h"

namespace latvox::client {

struct PartContent {
  std::string path;
  GridContent content;
};

// The union of parts.
struct JoinedContent {
  std::vector<Brick> bricks;        // lexicographic order
  std::vector<FieldValues> fields;  // those of each part
  std::vector<Vec3i> neighbors;     // of fields of links
  uint64_t shared_bricks = 0;       // bricks of the parts beyond those of the union
};

// `disjoint`: a brick in two parts is an error. Preconditions: there is a part; the bricks of each differ, and the
// fields have a value for each voxel. Memory: 28 bytes for each brick of the parts, and the result. Errors:
// INVALID_ARGUMENT, with the file: other fields or neighbors than in the first part; another value for a voxel of two
// parts; a brick in two parts.
absl::StatusOr<JoinedContent> JoinContents(const std::vector<PartContent>& parts, bool disjoint);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_CONTENT_JOIN_H_
