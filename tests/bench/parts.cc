#include "tests/bench/parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace latvox {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;
using Point = std::array<double, 3>;
using Loop = std::vector<Point>;

// Where a part stands: its own axes, and its origin.
struct Place {
  Point u{1, 0, 0}, v{0, 1, 0}, w{0, 0, 1}, at{};

  Point operator()(double x, double y, double z) const {
    Point p = at;
    for (size_t m = 0; m < 3; ++m) p[m] += x * u[m] + y * v[m] + z * w[m];
    return p;
  }
};

Point Cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Point Unit(Point v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  for (double& x : v) x /= length;
  return v;
}

// Returns a place with its third axis along a direction.
Place Along(const Point& direction, const Point& at) {
  const Point w = Unit(direction), u = Unit(Cross(std::abs(w[0]) < 0.6 ? Point{1, 0, 0} : Point{0, 1, 0}, w));
  return {u, Cross(w, u), w, at};
}

// Returns the points (radius(n), n turns / count) of a plane of the place.
template <class Radius>
Loop LoopOf(const Place& place, size_t count, double z, Radius&& radius) {
  Loop loop;
  for (size_t n = 0; n < count; ++n) {
    const double angle = kTurn * static_cast<double>(n) / static_cast<double>(count), r = radius(n);
    loop.push_back(place(r * std::cos(angle), r * std::sin(angle), z));
  }
  return loop;
}

Loop Circle(const Place& place, size_t count, double z, double radius) {
  return LoopOf(place, count, z, [&](size_t) { return radius; });
}

class Parts {
 public:
  // Adds the faces between each loop and the next one, which has as many points. A loop of one point repeated closes a
  // part. Faces without area are left out.
  void Add(const std::vector<Loop>& loops) {
    const auto first = static_cast<uint32_t>(mesh_.vertices.size()), size = static_cast<uint32_t>(loops[0].size());
    for (const Loop& loop : loops) {
      for (const Point& p : loop) {
        mesh_.vertices.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
      }
    }
    for (uint32_t row = 0; row + 1 < loops.size(); ++row) {
      for (uint32_t n = 0; n < size; ++n) {
        const uint32_t a = first + row * size + n, b = first + row * size + (n + 1) % size;
        AddTriangle(a, b, a + size);
        AddTriangle(b, b + size, a + size);
      }
    }
  }
  // Adds a solid between two heights with a hole through it. The outlines have as many points.
  template <class Outer, class Inner>
  void AddRing(double low, double high, Outer&& outer, Inner&& inner) {
    Add({outer(low), outer(high), inner(high), inner(low), outer(low)});
  }
  void AddTube(const Place& place, size_t sides, double length, double radius, double bore) {
    AddRing(
        0, length, [&](double z) { return Circle(place, sides, z, radius); },
        [&](double z) { return Circle(place, sides, z, bore); });
  }
  TriangleMesh Take() { return std::move(mesh_); }

 private:
  void AddTriangle(uint32_t a, uint32_t b, uint32_t c) {
    const auto& v = mesh_.vertices;
    if (v[a] != v[b] && v[b] != v[c] && v[c] != v[a]) mesh_.triangles.push_back({a, b, c});
  }

  TriangleMesh mesh_;
};

// Random numbers that the standard defines, which it does for no distribution.
class Fractions {
 public:
  double operator()() { return static_cast<double>(random_()) * 0x1p-32; }
  double Between(double low, double high) { return low + (high - low) * (*this)(); }

 private:
  std::mt19937 random_{1};
};

TriangleMesh Gears() {
  constexpr size_t kTeeth = 32, kPerTooth = 8;
  Parts parts;
  const std::array<Place, 4> places{{{.at = {0.25, 0.25, 0}},
                                     Along({1, 0, 0}, {0, 0.75, 0.3}),
                                     Along({0.3, 0.2, 0.9}, {0.75, 0.3, 0.1}),
                                     Along({-0.6, 0.5, 0.4}, {0.8, 0.75, 0.4})}};
  for (const Place& place : places) {
    const auto tooth = [](size_t n) { return n % kPerTooth < kPerTooth / 2 ? 0.25 : 0.225; };
    parts.AddRing(
        0, 0.1, [&](double z) { return LoopOf(place, kTeeth * kPerTooth, z, tooth); },
        [&](double z) { return Circle(place, kTeeth * kPerTooth, z, 0.08); });
  }
  return parts.Take();
}

TriangleMesh Plates() {
  constexpr int kHoles = 12;
  constexpr size_t kSides = 32;
  constexpr double kSide = 1.0 / kHoles, kThick = 0.012;
  Parts parts;
  const std::array<Place, 4> places{{{},
                                     {.u = {0, 1, 0}, .v = {0, 0, 1}, .w = {1, 0, 0}},
                                     Along({0.2, 0.3, 0.9}, {0, 0, 0.5}),
                                     Along({0.9, -0.5, 0.3}, {0.5, 0.2, 0})}};
  for (const Place& place : places) {
    for (int n = 0; n < kHoles * kHoles; ++n) {
      Place cell = place;
      cell.at = place((n / kHoles + 0.5) * kSide, (n % kHoles + 0.5) * kSide, 0);
      // The border of a square: the larger of |cos| and |sin| is constant.
      const auto square = [](size_t m) {
        const double angle = kTurn * static_cast<double>(m) / kSides;
        return kSide / 2 / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
      };
      const auto border = [&](double z) { return LoopOf(cell, kSides, z, square); };
      const auto hole = [&](double z) { return Circle(cell, kSides, z, 0.3 * kSide); };
      parts.Add({border(0), hole(0), hole(kThick), border(kThick)});
    }
  }
  return parts.Take();
}

TriangleMesh Honeycomb() {
  constexpr int kCells = 14;
  constexpr double kWidth = 1.0 / kCells, kWall = 0.008;
  Parts parts;
  for (int row = 0; row < kCells; ++row) {
    for (int n = 0; n < kCells; ++n) {
      const Place cell{.u = {0, 1, 0},
                       .v = {1, 0, 0},
                       .at = {(n + 0.5 * (row % 2)) * kWidth, row * kWidth * std::numbers::sqrt3 / 2, 0}};
      const auto outline = [&](double width, double z) { return Circle(cell, 6, z, width / std::numbers::sqrt3); };
      parts.Add({outline(kWidth, 0), outline(kWidth - kWall, 0), outline(kWidth - kWall, 0.5), outline(kWidth, 0.5)});
    }
  }
  return parts.Take();
}

TriangleMesh Threads() {
  constexpr size_t kSides = 48, kPerPitch = 12, kPitches = 24;
  constexpr double kPitch = 1.0 / kPitches;
  Parts parts;
  for (int bolt = 0; bolt < 9; ++bolt) {
    const Place place = Along({0.1 * (bolt % 3), 0.1 * (bolt / 3), 1}, {0.3 * (bolt / 3), 0.3 * (bolt % 3), 0});
    std::vector<Loop> loops{Circle(place, kSides, 0, 0)};
    for (size_t ring = 0; ring <= kPerPitch * kPitches; ++ring) {
      const double z = kPitch * static_cast<double>(ring) / kPerPitch;
      loops.push_back(LoopOf(place, kSides, z, [&](size_t n) {
        const double turns = z / kPitch - static_cast<double>(n) / kSides;
        return 0.08 + 0.04 * std::abs(turns - std::floor(turns) - 0.5);
      }));
    }
    loops.push_back(Circle(place, kSides, 1, 0));
    parts.Add(loops);
  }
  return parts.Take();
}

TriangleMesh Pipes() {
  Parts parts;
  Fractions fraction;
  for (size_t n = 0; n < 60; ++n) {
    Point at{fraction(), fraction(), fraction()}, along{};
    at[n % 3] = 0;
    along[n % 3] = 1;
    const double radius = fraction.Between(0.01, 0.04);
    parts.AddTube(Along(along, at), 24, 1, radius, radius - fraction.Between(0.004, 0.012));
  }
  return parts.Take();
}

TriangleMesh City() {
  Parts parts;
  Fractions fraction;
  for (int n = 0; n < 1000; ++n) {
    const double height = fraction.Between(0.02, 0.3), x = fraction.Between(0.005, 0.02),
                 y = fraction.Between(0.005, 0.02);
    const Place place{.at = {fraction(), fraction(), 0}};
    const auto outline = [&](double size, double z) {
      return Loop{place(size * x, size * y, z), place(-size * x, size * y, z), place(-size * x, -size * y, z),
                  place(size * x, -size * y, z)};
    };
    parts.Add({outline(0, 0), outline(1, 0), outline(1, height), outline(0, height)});
  }
  return parts.Take();
}

TriangleMesh Shells() {
  constexpr size_t kRings = 48, kSides = 96;
  Parts parts;
  for (int shell = 0; shell < 6; ++shell) {
    const double outer = 0.5 - 0.07 * shell, wall = 0.004 + 0.0015 * shell;
    for (const double radius : {outer, outer - wall}) {
      std::vector<Loop> loops;
      for (size_t ring = 0; ring <= kRings; ++ring) {
        const double angle = kTurn / 2 * static_cast<double>(ring) / kRings;
        const bool pole = ring % kRings == 0;
        loops.push_back(Circle({}, kSides, -radius * std::cos(angle), pole ? 0 : radius * std::sin(angle)));
      }
      parts.Add(loops);
    }
  }
  return parts.Take();
}

TriangleMesh Tree() {
  constexpr size_t kSides = 8;
  constexpr int kBranches = 1023;
  Parts parts;
  Fractions fraction;
  struct Branch {
    Point from, direction;
    double length, radius;
  };
  std::vector<Branch> branches{{{0, 0, 0}, {0, 0, 1}, 0.3, 0.024}};
  for (size_t n = 0; n < kBranches; ++n) {
    const auto [from, direction, length, radius] = branches[n];
    const Place place = Along(direction, from);
    parts.Add({Circle(place, kSides, 0, radius), Circle(place, kSides, length, 0.75 * radius)});
    for (const double side : {-1.0, 1.0}) {
      const Point next = Unit(place(side * fraction.Between(0.3, 0.9), fraction.Between(-0.9, 0.9), 1));
      Point turned;
      for (size_t m = 0; m < 3; ++m) turned[m] = next[m] - from[m];
      branches.push_back({place(0, 0, length), turned, 0.78 * length, 0.75 * radius});
    }
  }
  return parts.Take();
}

}  // namespace

std::optional<TriangleMesh> PartsNamed(std::string_view name) {
  constexpr std::pair<std::string_view, TriangleMesh (*)()> kParts[] = {
      {"gears", Gears}, {"plates", Plates}, {"honeycomb", Honeycomb}, {"threads", Threads},
      {"pipes", Pipes}, {"city", City},     {"shells", Shells},       {"tree", Tree}};
  for (const auto& [of, make] : kParts) {
    if (of == name) return make();
  }
  return std::nullopt;
}

}  // namespace latvox
