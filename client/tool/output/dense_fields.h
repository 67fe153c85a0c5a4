// The voxels of a box and their fields as dense arrays.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_DENSE_FIELDS_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_DENSE_FIELDS_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/tool/output/box_shape.h"
#include "client/tool/output/dense_box.h"
#include "latvox/types.h"

namespace latvox::client {

// For formats that hold at least one element.
inline constexpr IndexBox kOneElement = {{0, 0, 0}, {1, 1, 1}};

// One array over all lattice points of a box.
struct DenseArray {
  std::string name;
  NumberType type;    // of a component; kUint32 stands for int32, because numbers are below 2^31
  size_t components;  // of an element
  std::string empty;  // bytes of an element that is not a voxel
  std::function<void(uint64_t n, char* element)> put;
  bool is_label = false;  // numbers of parts, materials or triangles

  uint64_t bytes(const DenseBox& box) const { return box.rows() * box.row_elements() * empty.size(); }
};

// Collects voxels and fields, for arrays over the voxels' own box, in its shape. Memory: 88 bytes for each brick, and
// the fields. Not thread-safe.
class DenseFields {
 public:
  //   without_voxels   the box if there are neither voxels nor dims
  //   are_joined       the fields become one array: see Joined, below
  DenseFields(const std::vector<Field>& fields, DenseOrder order, const BoxShape& shape,
              const IndexBox& without_voxels = {}, bool are_joined = false);
  DenseFields(const DenseFields&) = delete;
  DenseFields& operator=(const DenseFields&) = delete;

  // Checks the box of the call, which bounds that of the voxels, so that a call fails before its work. Errors: those of
  // DenseBox::SetBox.
  absl::Status Begin(const Accepted& accepted, const std::string& target);

  // Precondition: the batch carries these fields; it may carry more. Errors: those of ShapedBox, as soon as the voxels
  // do not fit.
  absl::Status Add(const BrickBatch& batch);

  // Call it after the last batch, and then box(), corner() and Arrays().
  absl::Status Finish();

  // Returns `data`, uint8, 1 for a voxel and 0 elsewhere; then an array for each field, with the field's name, or one
  // for each label, with FractionName. Fields of links have a component for each neighbor. Where there is no voxel,
  // floats are NaN, int32 are -1, and other numbers 0.
  std::vector<DenseArray> Arrays() const;

  DenseBox& box() { return box_; }
  const GridTransform& grid() const { return grid_; }
  const std::vector<FieldValues>& values() const { return fields_; }  // of each field, in the order of Add

  // Returns the world position of the first element, which is a voxel's center.
  Vec3d corner() const { return grid_.ToWorld(box_.low()); }

 private:
  absl::Status SetBox(const std::optional<IndexBox>& box);

  const BoxShape shape_;
  const IndexBox without_voxels_;
  const bool are_joined_;
  std::string target_;
  VoxelBox voxels_;  // of all that were added
  GridTransform grid_;
  DenseBox box_;
  std::vector<FieldValues> fields_;
};

// Returns `data` if it is the only array of DenseFields. Otherwise returns the array of all fields; its elements have
// their components, one field after the other, and its name has commas. Precondition: their numbers have one type.
DenseArray Joined(std::vector<DenseArray> arrays);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_DENSE_FIELDS_H_
