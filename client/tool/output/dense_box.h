// The voxels of a box in the order of a dense array.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_DENSE_BOX_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_DENSE_BOX_H_

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "latvox/types.h"

namespace latvox::client {

// The coordinate that changes fastest from one element to the next.
enum class DenseOrder {
  kLastFastest,   // k: C order, as numpy has it
  kFirstFastest,  // i: as files of images have it
};

// The elements of a dense array: element [i - i0, j - j0, k - k0] is lattice point (i, j, k) of the box i0 <= i < i1
// and so on. Memory: 88 bytes for each brick. Not thread-safe.
class DenseBox {
 public:
  explicit DenseBox(DenseOrder order = DenseOrder::kLastFastest)
      : outer_(order == DenseOrder::kLastFastest ? 0 : 2), inner_(2 - outer_) {}

  // Without a box, the array has shape (0, 0, 0). Errors, naming `target`: RESOURCE_EXHAUSTED: an array of more than
  // 2^32 bytes.
  //   element_bytes   of the largest element
  absl::Status SetBox(const std::optional<IndexBox>& box, uint64_t element_bytes, const std::string& target);

  void Add(const BrickBatch& batch);

  // Call it after the last batch.
  void Sort();

  const Vec3i& low() const { return low_; }
  const std::array<uint64_t, 3>& shape() const { return shape_; }  // along i, j, k
  uint64_t rows() const { return shape_[outer_] * shape_[1]; }
  uint64_t row_elements() const { return shape_[inner_]; }

  // Calls visit(at, n) for each voxel of a row along the fastest coordinate, with its place in the row, ascending. The
  // n-th voxel that was added has number n.
  //   row   below rows(); fast if the rows come in order
  void ForEachInRow(uint64_t row, absl::FunctionRef<void(uint64_t at, uint64_t n)> visit);

 private:
  struct Placed {
    Brick brick;
    uint64_t first;  // number of its first voxel
  };

  // Finds the columns of bricks whose outer coordinate is `layer`.
  void EnterLayer(int32_t layer);

  // Calls visit(coordinate, n) for each voxel of a brick's row.
  void ForEachAlongK(const Placed& placed, size_t x, size_t y, absl::FunctionRef<void(int64_t, uint64_t)> visit) const;
  void ForEachAlongI(const Placed& placed, size_t y, size_t z, absl::FunctionRef<void(int64_t, uint64_t)> visit) const;

  const size_t outer_, inner_;  // axes: the slowest, and that of a row
  Vec3i low_{};
  std::array<uint64_t, 3> shape_{};
  std::vector<Placed> bricks_;
  uint64_t voxels_ = 0;
  std::optional<int32_t> layer_;
  std::vector<size_t> columns_;  // of the layer: the first brick of each j, and the end
};

// The bytes of one array over a DenseBox, row after row.
class DenseRows {
 public:
  //   empty   bytes of an element that is not a voxel
  //   put     writes the element of the n-th voxel
  DenseRows(DenseBox& box, std::string empty, std::function<void(uint64_t n, char* element)> put);

  // Replaces `chunk` by the next rows, about 1 MiB; by nothing at the end.
  void Next(std::string& chunk);

 private:
  DenseBox& box_;
  const std::string empty_;
  const std::function<void(uint64_t n, char* element)> put_;
  std::string empty_row_;
  uint64_t row_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_DENSE_BOX_H_
