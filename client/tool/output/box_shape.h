// The shape of a dense array, as the user asks for it.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_BOX_SHAPE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_BOX_SHAPE_H_

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "latvox/types.h"

namespace latvox::client {

struct BoxShape {
  uint32_t pad = 0;  // empty points on each side, beyond the box of the voxels
  // The number of points along i, j and k. The box of the voxels, with its padding, is in the middle; if one point is
  // left over, that is behind it.
  std::optional<Vec3i> dims = std::nullopt;
  bool operator==(const BoxShape&) const = default;
};

// Returns the box of the array, around another box. Errors: INVALID_ARGUMENT, naming `target`: it does not fit into
// dims.
absl::StatusOr<IndexBox> ShapedBox(const IndexBox& box, const BoxShape& shape, const std::string& target);

// The smallest box of the voxels that were added.
class VoxelBox {
 public:
  // Costs little if the brick lies inside already.
  void Add(const Brick& brick);

  // Returns nothing without a voxel.
  const std::optional<IndexBox>& box() const { return box_; }

 private:
  std::optional<IndexBox> box_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_BOX_SHAPE_H_
