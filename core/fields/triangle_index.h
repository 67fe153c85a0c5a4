// Finds the triangles near a point, however far the nearest one is.
#ifndef LATVOX_CORE_FIELDS_TRIANGLE_INDEX_H_
#define LATVOX_CORE_FIELDS_TRIANGLE_INDEX_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "core/band/metric.h"
#include "core/base/stop_signal.h"
#include "core/base/uninitialized.h"
#include "core/base/vec.h"
#include "core/snap/snap.h"

namespace latvox {

// A binary tree of boxes over the triangles, which are sorted along a Morton curve. Boxes lie in the metric's Cartesian
// coordinates, in units, around the local origin: x = root * v. They are a little too large, never too small, so a
// search misses no triangle. Threads: searches, any.
class TriangleIndex {
 public:
  // The metric need not outlive it. Once stopped, the index is meaningless.
  TriangleIndex(const SnappedMesh& mesh, const Metric& metric, StopSignal stop);

  // Prepares for MayFindOther.
  //   of_vertices   the numbers of each vertex, `count` of them; must outlive the index
  void SetNumbers(const SnappedMesh& mesh, std::span<const uint32_t> of_vertices, size_t count, StopSignal stop);

  // The memory for each triangle, and more while it is made.
  static constexpr uint64_t kBytesPerTriangle = 64;

  // Calls visit(triangle) once for each triangle within sqrt(bound) of the box `low` to `high`, and for some others.
  // Nearer triangles mostly come first. The box may be a point. visit may lower `bound`.
  template <class Visit>
  void ForEachNear(const Vec3d& low, const Vec3d& high, const double& bound, Visit&& visit) const {
    struct Entry {
      double square;
      size_t node;
    };
    std::array<Entry, 2 * 32> stack;  // a level leaves at most one entry
    size_t count = 0;
    stack[count++] = {SquareTo(1, low, high), 1};
    while (count > 0) {
      const auto [square, node] = stack[--count];
      if (square > bound) continue;
      if (node >= leaves_) {
        const size_t first = (node - leaves_) * kLeaf, end = std::min(first + kLeaf, order_.size());
        for (size_t n = first; n < end; ++n) visit(order_[n]);
        continue;
      }
      Entry near{SquareTo(2 * node, low, high), 2 * node}, far{SquareTo(2 * node + 1, low, high), 2 * node + 1};
      if (near.square > far.square) std::swap(near, far);
      stack[count++] = far;
      stack[count++] = near;
    }
  }

  // Returns false only if all corners of all triangles with a distance from a point of at most sqrt(bound) have these
  // numbers. Precondition: SetNumbers.
  bool MayFindOther(const Vec3d& point, double bound, const uint32_t* numbers) const {
    return MayFindOther(1, point, bound, numbers);
  }

 private:
  static constexpr size_t kLeaf = 4;  // triangles
  static constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max(), kMixed = kNone - 1;

  struct Box {
    std::array<float, 3> low, high;
  };

  void Sort(const SnappedMesh& mesh, StopSignal stop);
  static Box Around(const Box& a, const Box& b);
  Box BoxOf(const SnappedMesh& mesh, const Metric& metric, size_t leaf) const;

  // The square of the distance from a box to that of a node.
  double SquareTo(size_t node, const Vec3d& low, const Vec3d& high) const {
    double square = 0;
    for (size_t m = 0; m < 3; ++m) {
      const double beyond =
          std::max({double{boxes_[node].low[m]} - high[m], low[m] - double{boxes_[node].high[m]}, 0.0});
      square += beyond * beyond;
    }
    return square;
  }

  bool MayFindOther(size_t node, const Vec3d& point, double bound, const uint32_t* numbers) const;
  bool AreEqual(uint32_t vertex, const uint32_t* numbers) const {
    return std::equal(numbers, numbers + count_, &of_vertices_[vertex * count_]);
  }
  uint32_t Merged(uint32_t vertex, uint32_t other) const;

  std::vector<uint32_t> order_;     // the triangles, kLeaf to a leaf
  size_t leaves_ = 1;               // a power of two
  UninitializedVector<Box> boxes_;  // node n has the children 2n and 2n + 1; leaves from leaves_ on; empty ones are far
  // By node: a vertex with the numbers of all its triangles; kMixed if they differ; kNone if it is empty.
  std::vector<uint32_t> vertices_;
  std::span<const uint32_t> of_vertices_;
  size_t count_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_FIELDS_TRIANGLE_INDEX_H_
