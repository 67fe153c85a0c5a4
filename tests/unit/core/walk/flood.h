// A flood fill, point by point: the independent judge of walks.
#ifndef LATVOX_TESTS_UNIT_CORE_WALK_FLOOD_H_
#define LATVOX_TESTS_UNIT_CORE_WALK_FLOOD_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "core/base/vec.h"
#include "tests/unit/core/exact.h"

namespace latvox {

using oracle::Int3;
using Points = std::set<Int3>;

inline Int3 Plus(const Int3& a, const Int3& b, int64_t times = 1) {
  return {a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]};
}

// The points of a box, by brute force.
class Flood {
 public:
  // All points beyond the box are outside.
  Flood(const oracle::Box& box, const std::vector<Int3>& directions) : box_(box), directions_(directions) {}

  // Each point of the box: whether it is a wall, or was reached.
  using Marks = std::vector<uint8_t>;
  Marks MarksOf(const Points& points) const {
    Marks marks(Size());
    for (const Int3& z : points) {
      if (box_.Contains(z)) marks[NumberOf(z)] = 1;
    }
    return marks;
  }
  Points Marked(Marks marks) const {
    for (uint8_t& mark : marks) mark ^= 1;
    return Unmarked(marks);
  }
  Points Unmarked(const Marks& marks) const {
    Points points;
    for (size_t n = 0; n < marks.size(); ++n) {
      if (marks[n] == 0) points.insert(PointAt(n));
    }
    return points;
  }

  // The points that a walk reaches from outside, or from a seed.
  Marks FromOutside(const Marks& walls) const {
    Marks reached(Size());
    std::vector<Int3> todo;
    for (size_t n = 0; n < walls.size(); ++n) {
      const Int3 z = PointAt(n);
      bool is_border = false;
      for (const Int3& q : directions_) is_border |= !box_.Contains(Plus(z, q)) || !box_.Contains(Plus(z, q, -1));
      if (!is_border || walls[n] != 0) continue;
      reached[n] = 1;
      todo.push_back(z);
    }
    Spread(walls, reached, std::move(todo));
    return reached;
  }
  Marks FromSeed(const Marks& walls, const Int3& seed) const {
    Marks reached(Size());
    reached[NumberOf(seed)] = 1;
    Spread(walls, reached, {seed});
    return reached;
  }

  // The sizes of the connected parts of the points that are no walls and not reached, descending.
  std::vector<uint64_t> Cavities(const Marks& walls, Marks seen) const {
    std::vector<uint64_t> sizes;
    for (size_t n = 0; n < seen.size(); ++n) {
      if (walls[n] != 0 || seen[n] != 0) continue;
      const Marks part = FromSeed(walls, PointAt(n));
      uint64_t size = 0;
      for (size_t m = 0; m < seen.size(); ++m) {
        seen[m] |= part[m];
        size += part[m];
      }
      sizes.push_back(size);
    }
    std::sort(sizes.rbegin(), sizes.rend());
    return sizes;
  }

  // Marks the points that no wall holds and that lie within the distance of a reached point.
  //   from_outside   whether the points beyond the box are reached
  Marks Grown(const Marks& walls, const Marks& reached, const Mat3d& basis, double distance,
              bool from_outside = true) const {
    const int64_t most = 12;
    std::vector<Int3> ball;
    for (int64_t i = -most; i <= most; ++i) {
      for (int64_t j = -most; j <= most; ++j) {
        for (int64_t k = -most; k <= most; ++k) {
          const Vec3d v = Apply(basis, Vec3d{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)});
          if (Dot(v, v) <= distance * distance) ball.push_back({i, j, k});
        }
      }
    }
    Marks grown = reached;
    for (size_t n = 0; n < walls.size(); ++n) {
      if (walls[n] != 0 || reached[n] != 0) continue;
      const Int3 z = PointAt(n);
      for (const Int3& v : ball) {
        const Int3 other = Plus(z, v);
        if (box_.Contains(other) ? reached[NumberOf(other)] != 0 : from_outside) grown[n] = 1;
      }
    }
    return grown;
  }

  size_t NumberOf(const Int3& z) const {
    return static_cast<size_t>(((z[0] - box_.lo[0]) * Side(1) + z[1] - box_.lo[1]) * Side(2) + z[2] - box_.lo[2]);
  }

 private:
  int64_t Side(size_t m) const { return box_.hi[m] - box_.lo[m] + 1; }
  size_t Size() const { return static_cast<size_t>(Side(0) * Side(1) * Side(2)); }
  Int3 PointAt(size_t number) const {
    const auto n = static_cast<int64_t>(number);
    return Plus(box_.lo, {n / (Side(1) * Side(2)), n / Side(2) % Side(1), n % Side(2)});
  }
  void Spread(const Marks& walls, Marks& reached, std::vector<Int3> todo) const {
    while (!todo.empty()) {
      const Int3 z = todo.back();
      todo.pop_back();
      for (const Int3& q : directions_) {
        for (const int64_t sign : {-1, 1}) {
          const Int3 next = Plus(z, q, sign);
          if (!box_.Contains(next)) continue;
          const size_t n = NumberOf(next);
          if (walls[n] != 0 || reached[n] != 0) continue;
          reached[n] = 1;
          todo.push_back(next);
        }
      }
    }
  }

  const oracle::Box box_;
  const std::vector<Int3> directions_;
};

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_WALK_FLOOD_H_
