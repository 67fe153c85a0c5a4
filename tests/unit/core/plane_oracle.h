// An exact, slow definition of a digitized curve in the plane. Like tests/oracle, it shares no code with core. It
// intersects every link near a segment with it by Cramer's rule in rationals. The tie-breaking shift is a polynomial in
// an infinitesimal. Curves are in lattice coordinates, in units of 1/256 pixel.
#ifndef LATVOX_TESTS_UNIT_CORE_PLANE_ORACLE_H_
#define LATVOX_TESTS_UNIT_CORE_PLANE_ORACLE_H_

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace latvox::plane_oracle {

using Int2 = std::array<int64_t, 2>;
using Line = std::array<Int2, 2>;  // a segment
using Curve = std::vector<Line>;
using Ends = std::pair<Int2, Int2>;  // nearer, farther; as a link: lower, upper
using Edges = std::set<Ends>;

struct Box {
  Int2 lo, hi;  // both included
  bool Contains(const Int2& z) const { return lo[0] <= z[0] && z[0] <= hi[0] && lo[1] <= z[1] && z[1] <= hi[1]; }
};

// c[0] + c[1] eps + c[2] eps^2, eps a positive infinitesimal.
using Polynomial = std::array<mpq_class, 3>;

inline int Sign(const Polynomial& p) {
  for (const mpq_class& c : p) {
    if (sgn(c) != 0) return sgn(c);
  }
  throw std::logic_error("the shift leaves no tie");
}

// (p - a) / b
inline Polynomial Affine(Polynomial p, const mpq_class& a, const mpq_class& b) {
  p[0] -= a;
  for (mpq_class& c : p) c /= b;
  return p;
}

// Intersects the segment a -> b, shifted by (eps, eps^2), with the link z -> z + q.
inline std::optional<Ends> Meet(const Line& line, const Int2& z, const Int2& q) {
  const Int2 d{line[1][0] - line[0][0], line[1][1] - line[0][1]};
  const Int2 step{256 * q[0], 256 * q[1]};
  const mpq_class det = mpq_class(step[0] * d[1]) - mpq_class(step[1] * d[0]);
  if (sgn(det) == 0) return std::nullopt;
  // u d - s step = w, w = 256 z - a - (eps, eps^2)
  const Polynomial w0{256 * z[0] - line[0][0], -1, 0}, w1{256 * z[1] - line[0][1], 0, -1};
  Polynomial u, s;
  for (size_t n = 0; n < 3; ++n) {
    u[n] = w1[n] * step[0] - w0[n] * step[1];
    s[n] = d[0] * w1[n] - d[1] * w0[n];
  }
  u = Affine(u, 0, det);
  s = Affine(s, 0, det);
  if (Sign(u) < 0 || Sign(Affine(u, 1, 1)) > 0 || Sign(s) < 0 || Sign(Affine(s, 1, 1)) > 0) return std::nullopt;
  const Int2 next{z[0] + q[0], z[1] + q[1]};
  return Sign(Affine(s, mpq_class(1, 2), 1)) < 0 ? Ends{z, next} : Ends{next, z};
}

// All crossings with links along q, with the number of segments that make each. With a window, those with the nearer
// end in it.
inline std::map<Ends, int> Crossings(const Curve& curve, const Int2& q, const std::optional<Box>& window = {}) {
  std::map<Ends, int> crossings;
  for (const Line& line : curve) {
    Box box;  // of z such that the link's closed rectangle can touch the segment's
    for (size_t m = 0; m < 2; ++m) {
      const auto [low, high] = std::minmax({line[0][m], line[1][m]});
      box.lo[m] = (low >> 8) - std::max<int64_t>(q[m], 0);
      box.hi[m] = (high >> 8) + 1 - std::min<int64_t>(q[m], 0);
      if (!window) continue;
      box.lo[m] = std::max(box.lo[m], window->lo[m] - std::abs(q[m]));
      box.hi[m] = std::min(box.hi[m], window->hi[m] + std::abs(q[m]));
    }
    for (int64_t i = box.lo[0]; i <= box.hi[0]; ++i) {
      for (int64_t j = box.lo[1]; j <= box.hi[1]; ++j) {
        const auto ends = Meet(line, {i, j}, q);
        if (ends && (!window || window->Contains(ends->first))) ++crossings[*ends];
      }
    }
  }
  return crossings;
}

struct Digitized {
  std::set<Int2> pixels;  // nearer ends
  Edges edges;
};

inline Digitized Digitize(const Curve& curve, const std::vector<Int2>& directions) {
  Digitized out;
  for (const Int2& q : directions) {
    for (const auto& [ends, count] : Crossings(curve, q)) {
      out.pixels.insert(ends.first);
      out.edges.insert(std::minmax(ends.first, ends.second));
    }
  }
  return out;
}

inline size_t Tunnels(const std::set<Int2>& pixels, const Edges& edges) {
  return static_cast<size_t>(std::count_if(edges.begin(), edges.end(), [&](const Ends& e) {
    return !pixels.contains(e.first) && !pixels.contains(e.second);
  }));
}

inline bool CanLeave(const Int2& z, const std::set<Int2>& pixels, const Edges& edges) {
  return std::all_of(edges.begin(), edges.end(), [&](const Ends& e) {
    return (e.first != z && e.second != z) || pixels.contains(e.first == z ? e.second : e.first);
  });
}

inline size_t Redundant(const std::set<Int2>& pixels, const Edges& edges) {
  return static_cast<size_t>(
      std::count_if(pixels.begin(), pixels.end(), [&](const Int2& z) { return CanLeave(z, pixels, edges); }));
}

inline std::set<Int2> Thinned(std::set<Int2> pixels, const Edges& edges) {
  for (int64_t parity = 0; parity < 4; ++parity) {
    std::set<Int2> left = pixels;
    for (const Int2& z : pixels) {
      if (((z[0] & 1) << 1 | (z[1] & 1)) == parity && CanLeave(z, pixels, edges)) left.erase(z);
    }
    pixels = left;
  }
  return pixels;
}

// A contour in lattice coordinates, units of 1/256 pixel.
struct Contour {
  std::vector<Int2> points;
  bool closed = false;
};
using Drawing = std::vector<Contour>;

inline Curve CurveOf(const Drawing& drawing) {
  Curve curve;
  for (const Contour& contour : drawing) {
    const auto& p = contour.points;
    for (size_t n = 1; n < p.size(); ++n) curve.push_back({p[n - 1], p[n]});
    if (contour.closed) curve.push_back({p.back(), p.front()});
  }
  return curve;
}

struct NamedDrawing {
  std::string name;
  Drawing drawing;
};

// Points on a grid of `unit`, within +-range.
inline Contour RandomContour(std::mt19937& random, size_t points, int64_t unit, int64_t range, bool closed) {
  std::uniform_int_distribution<int64_t> coordinate(-range / unit, range / unit);
  Contour contour{{}, closed};
  for (size_t n = 0; n < points; ++n) contour.points.push_back({unit * coordinate(random), unit * coordinate(random)});
  return contour;
}

// Curves that are most likely to cause errors. Deterministic in the seed.
inline std::vector<NamedDrawing> AdversarialDrawings(unsigned seed, const std::vector<Int2>& directions) {
  std::mt19937 random(seed);
  std::vector<NamedDrawing> all;
  for (int64_t unit : {256, 128, 64, 1}) {
    const std::string on = " on multiples of " + std::to_string(unit);
    all.push_back({"self-crossing outline" + on, {RandomContour(random, 8, unit, 1200, true)}});
    all.push_back({"open polyline" + on, {RandomContour(random, 8, unit, 1200, false)}});
  }
  Drawing along, beside, between;
  for (const Int2& q : directions) {
    const auto move = [&](int64_t x, int64_t y, int64_t times) {
      return Int2{x + 256 * times * q[0], y + 256 * times * q[1]};
    };
    along.push_back({{move(0, 0, -2), move(0, 0, 1), move(0, 0, 3)}});
    beside.push_back({{move(128, 0, -1), move(128, 0, 2)}});
    between.push_back({{move(128 * q[0], 128 * q[1], 0), move(128, 128, 2), move(-128, 128, -1)}, true});
  }
  all.push_back({"segments along lattice lines", along});
  all.push_back({"segments halfway beside lattice lines", beside});
  all.push_back({"through the middles of edges and vertices of cells", between});
  const Contour outline = RandomContour(random, 5, 32, 900, true);
  Contour reversed = outline;
  std::reverse(reversed.points.begin(), reversed.points.end());
  all.push_back({"one outline three times", {outline, outline, reversed}});
  all.push_back({"zero length", {{{{0, 0}}}, {{{128, 128}, {128, 128}}, true}, {{{256, 0}, {256, 0}, {700, 90}}}}});
  all.push_back({"closer than a pixel",
                 {{{{-900, -401}, {900, 433}}}, {{{-900, -400}, {900, 434}}}, {{{-900, -361}, {900, 473}}}}});
  Drawing tiny;
  for (int n = 0; n < 12; ++n) {
    Contour contour = RandomContour(random, 4, 1, 150, true);
    const Contour at = RandomContour(random, 1, 64, 900, false);
    for (Int2& p : contour.points) p = {p[0] + at.points[0][0], p[1] + at.points[0][1]};
    tiny.push_back(contour);
  }
  all.push_back({"outlines smaller than a pixel", tiny});
  Drawing spikes;
  for (int n = 0; n < 10; ++n) {
    spikes.push_back({{{0, 0}, RandomContour(random, 1, 1, 1000, false).points[0]}});
    spikes.push_back({{{128, 128}, RandomContour(random, 1, 128, 1000, false).points[0]}});
  }
  all.push_back({"spikes from a pixel and from a vertex of a cell", spikes});
  return all;
}

}  // namespace latvox::plane_oracle

#endif  // LATVOX_TESTS_UNIT_CORE_PLANE_ORACLE_H_
