// Which numbers of the mesh come near the cells of a cube: the bricks of a tile, or the voxels of a brick.
#ifndef LATVOX_CORE_FIELDS_NEAR_NUMBERS_H_
#define LATVOX_CORE_FIELDS_NEAR_NUMBERS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/base/vec.h"
#include "core/fields/plan.h"
#include "core/snap/snap.h"

namespace latvox {

// Mostly all triangles near a cell belong to one part. Then it does not matter which one is nearest to a voxel. One
// pass over the triangles near a cube finds that for its 8^3 cells. A thread reuses it from cube to cube.
class NearNumbers {
 public:
  // The sides of cells: 2^cell_bits voxels.
  explicit NearNumbers(int cell_bits) : cell_bits_(cell_bits) {}

  // Begins a cube. Once stopped, the result is meaningless. The plan must live while this is used.
  //   plan        with near_reach
  //   triangles   all that come within that reach of the cube's lattice points, and maybe others; must live as well
  //   low         the cube's lowest point, local
  void Begin(const SnappedMesh& mesh, const FieldPlan& plan, std::span<const uint32_t> triangles, const Vec3i& low,
             StopSignal stop);

  // Returns the numbers near a cell, one for each of plan.of_mesh: all corners of all triangles nearby have them. Empty
  // if corners differ, or if no triangle is near.
  //   cell   its place in the cube, 0 to 7 on each axis
  std::span<const uint32_t> Agreed(const Vec3i& cell) const {
    const Row& row = rows_[RowOf(cell[0], cell[1])];
    const auto any = static_cast<uint8_t>(row.any >> 8 * cell[2]), all = static_cast<uint8_t>(row.all >> 8 * cell[2]);
    if (any != all) return {};
    return {&numbers_[kinds_[any - size_t{1}] * count_], count_};
  }

  // Returns the triangles near a cell, and maybe others, valid until the next call. Cells in lexicographic order share
  // most of the work.
  std::span<const uint32_t> TrianglesNear(const Vec3i& cell);

  // The memory for each triangle near the cube.
  static constexpr uint64_t kBytesPerTriangle = 28;

 private:
  static constexpr int kSide = 8;  // cells
  // Where more kinds of numbers meet, cells with the others count as cells whose triangles differ.
  static constexpr size_t kMostKinds = 32;
  static constexpr uint8_t kMixed = 255;  // the kind of triangles whose corners differ

  // Triangles that follow each other in the list, and come near the same slabs of cells along each axis: bits 0 to 7
  // along i, 8 to 15 along j, 16 to 23 along k. A cell is near if its three slabs are. Small triangles that follow each
  // other mostly are neighbors, so their runs are long. Bits 24 to 31 are the number of triangles below 1.
  struct Run {
    uint32_t slabs_and_more;
    uint32_t first;  // its place in the list
  };
  static constexpr int kMoreShift = 3 * kSide;
  static constexpr uint32_t kMostMore = 255;

  // The cells of a row, a byte for each: the bits that any or all of the kinds nearby have. They are equal if there is
  // one kind. Kinds are 1 and more.
  struct Row {
    uint64_t any = 0, all = ~uint64_t{0};
  };

  static size_t RowOf(int32_t i, int32_t j) { return static_cast<size_t>(i * kSide + j); }
  bool AreEqual(uint32_t vertex, uint32_t other) const {
    const uint32_t *const a = &numbers_[vertex * count_], *const b = &numbers_[other * count_];
    if (a[0] != b[0]) return false;
    for (size_t n = 1; n < count_; ++n) {
      if (a[n] != b[n]) return false;
    }
    return true;
  }
  uint8_t KindOf(const std::array<uint32_t, 3>& corners);
  uint8_t NewKind(const std::array<uint32_t, 3>& corners);
  void AddToRun(uint32_t slabs, uint32_t place);
  // What was marked last: cells, as the kernel numbers them, and the numbers of its kind; null if it is kMixed.
  struct Marked {
    uint32_t cells;
    uint32_t slabs = 0;
    const uint32_t* numbers = nullptr;
  };
  Marked Mark(uint32_t cells, uint8_t kind);
  bool HasNumbers(const std::array<uint32_t, 3>& corners, const uint32_t* numbers) const;
  static void Keep(const std::vector<Run>& from, int slab, std::vector<Run>& kept);

  const int cell_bits_;
  const uint32_t* numbers_ = nullptr;  // of vertices, count_ of each
  size_t count_ = 0;
  std::array<Row, size_t{kSide} * kSide> rows_;
  std::vector<uint32_t> kinds_;            // for each kind, a vertex that has its numbers
  uint8_t last_kind_ = kMixed;             // of a triangle
  std::array<int32_t, 2> of_row_{-1, -1};  // i and j of row_
  std::span<const uint32_t> triangles_;
  std::vector<Run> all_, slab_, row_;  // slab_: near the slab of i; row_: also near that of j
  std::vector<uint32_t> near_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_FIELDS_NEAR_NUMBERS_H_
