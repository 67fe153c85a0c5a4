// The inside of a mesh by the exact oracle, and bodies for it.
#ifndef LATVOX_TESTS_UNIT_CORE_SOLID_LINE_FILL_H_
#define LATVOX_TESTS_UNIT_CORE_SOLID_LINE_FILL_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "core/request/solid.h"
#include "tests/oracle/oracle.h"

namespace latvox {

using oracle::Int3;

inline bool IsIn(InteriorRule rule, int sum) {
  switch (rule) {
    case InteriorRule::kParity:
      return sum % 2 != 0;
    case InteriorRule::kPositive:
      return sum > 0;
    default:
      return sum != 0;
  }
}

struct LineFill {
  std::set<Int3> inside;    // on balanced lines
  uint64_t unbalanced = 0;  // lines
};

// The inside of lattice points by lines along q, line by line, between crossings.
inline LineFill FillAlong(const oracle::Mesh& mesh, const Int3& q, InteriorRule rule) {
  const size_t axis = q[0] != 0 ? 0 : q[1] != 0 ? 1 : 2;
  std::map<Int3, std::map<int64_t, int>> lines;  // representative -> lowest step above a crossing -> signs
  for (const oracle::Crossing& crossing : oracle::Crossings(mesh, q)) {
    const Int3 line = oracle::LineOf(crossing.near_end, q);
    const auto step = [&](const Int3& z) { return (z[axis] - line[axis]) / q[axis]; };
    lines[line][std::max(step(crossing.near_end), step(crossing.far_end))] -= crossing.orientation;
  }
  LineFill fill;
  for (const auto& [line, changes] : lines) {
    std::set<Int3> inside;
    int sum = 0;
    int64_t last = 0;
    for (const auto& [step, change] : changes) {
      for (int64_t m = last; m < step && IsIn(rule, sum); ++m) {
        inside.insert({line[0] + m * q[0], line[1] + m * q[1], line[2] + m * q[2]});
      }
      sum += change;
      last = step;
    }
    if (rule == InteriorRule::kParity ? sum % 2 != 0 : sum != 0) {
      ++fill.unbalanced;
    } else {
      fill.inside.insert(inside.begin(), inside.end());
    }
  }
  return fill;
}

inline void AddTetrahedron(const std::array<Int3, 4>& v, bool inside_out, oracle::Mesh& mesh) {
  for (auto [a, b, c] : {std::array{0, 1, 2}, std::array{0, 2, 3}, std::array{0, 3, 1}, std::array{1, 3, 2}}) {
    if (inside_out) std::swap(a, b);
    mesh.push_back({v[static_cast<size_t>(a)], v[static_cast<size_t>(b)], v[static_cast<size_t>(c)]});
  }
}

// Parallelepipeds along the axes of lattice coordinates, oriented outwards.
inline oracle::Mesh Box(const Int3& low, const Int3& high) {
  const auto corner = [&](int n) {
    return Int3{(n & 4) != 0 ? high[0] : low[0], (n & 2) != 0 ? high[1] : low[1], (n & 1) != 0 ? high[2] : low[2]};
  };
  oracle::Mesh mesh;  // faces -k, +k, -j, +j, -i, +i
  for (const auto& [a, b, c, d] : {std::array{0, 2, 6, 4}, std::array{1, 5, 7, 3}, std::array{0, 4, 5, 1},
                                   std::array{2, 3, 7, 6}, std::array{0, 1, 3, 2}, std::array{4, 6, 7, 5}}) {
    mesh.push_back({corner(a), corner(b), corner(c)});
    mesh.push_back({corner(a), corner(c), corner(d)});
  }
  return mesh;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_SOLID_LINE_FILL_H_
