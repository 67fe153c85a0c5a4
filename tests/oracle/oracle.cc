#include "tests/oracle/oracle.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <utility>

namespace latvox::oracle {
namespace {

void Require(bool invariant, const char* what) {
  if (!invariant) throw std::logic_error(what);
}

// c[0] + c[1] eps + c[2] eps^2 + c[3] eps^3 for a positive infinitesimal eps: its sign is that of the first nonzero
// coefficient.
struct Polynomial {
  std::array<mpz_class, 4> c;
  int Sign() const {
    for (const mpz_class& coefficient : c) {
      if (sgn(coefficient) != 0) return sgn(coefficient);
    }
    return 0;
  }
};

Polynomial operator+(const Polynomial& a, const Polynomial& b) {
  Polynomial sum;
  for (size_t i = 0; i < 4; ++i) sum.c[i] = a.c[i] + b.c[i];
  return sum;
}

Polynomial operator-(const Polynomial& a, const mpz_class& b) {
  Polynomial difference = a;
  difference.c[0] -= b;
  return difference;
}

Polynomial operator*(const Polynomial& a, const mpz_class& factor) {
  Polynomial product;
  for (size_t i = 0; i < 4; ++i) product.c[i] = a.c[i] * factor;
  return product;
}

using Vector = std::array<mpz_class, 3>;

Vector ToVector(const Int3& v) { return {v[0], v[1], v[2]}; }
Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector operator*(const Vector& a, const mpz_class& m) { return {a[0] * m, a[1] * m, a[2] * m}; }
mpz_class Dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector Cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// a . (p - (eps, eps^2, eps^3))
Polynomial DotShifted(const Vector& a, const Vector& p) { return {{Dot(a, p), -a[0], -a[1], -a[2]}}; }

Int3 Step(const Int3& z, const Int3& q, int64_t times) {
  return {z[0] + times * q[0], z[1] + times * q[1], z[2] + times * q[2]};
}

// Lines of the bundle along q are named by their lattice point with 0 <= z[axis] < |q[axis]|: there is exactly one.
size_t NamingAxis(const Int3& q) {
  size_t best = 3;
  for (size_t axis = 0; axis < 3; ++axis) {
    if (q[axis] != 0 && (best == 3 || std::abs(q[axis]) < std::abs(q[best]))) best = axis;
  }
  Require(best < 3, "a direction is not zero");
  return best;
}

struct Interval {
  int64_t lo;
  int64_t hi;
};

// The integers between the smallest and the largest coordinate `axis` of the points (mesh units), each moved along q to
// the plane x[naming] = level (level and result in voxels).
Interval Shadow(const std::vector<Int3>& points, const Int3& q, size_t naming, int64_t level, size_t axis) {
  mpq_class lo, hi;
  for (size_t i = 0; i < points.size(); ++i) {
    const mpq_class along(mpz_class(points[i][naming] - kUnitsPerVoxel * level), mpz_class(q[naming]));
    mpq_class moved = along;
    moved.canonicalize();
    moved = (points[i][axis] - moved * q[axis]) / kUnitsPerVoxel;
    if (i == 0 || moved < lo) lo = moved;
    if (i == 0 || moved > hi) hi = moved;
  }
  mpz_class first, last;
  mpz_cdiv_q(first.get_mpz_t(), lo.get_num_mpz_t(), lo.get_den_mpz_t());
  mpz_fdiv_q(last.get_mpz_t(), hi.get_num_mpz_t(), hi.get_den_mpz_t());
  return {first.get_si(), last.get_si()};
}

std::vector<Int3> Corners(const Box& box) {
  std::vector<Int3> corners;
  for (int64_t x : {box.lo[0], box.hi[0]}) {
    for (int64_t y : {box.lo[1], box.hi[1]}) {
      for (int64_t z : {box.lo[2], box.hi[2]}) {
        corners.push_back({kUnitsPerVoxel * x, kUnitsPerVoxel * y, kUnitsPerVoxel * z});
      }
    }
  }
  return corners;
}

// The names of all lines along q that could meet both the triangle and the box: those whose points, moved along q, lie
// in the triangle's bounding rectangle. An infinitesimal shift brings no other lattice point into a closed rectangle.
std::vector<Int3> CandidateLines(const Triangle& triangle, const Int3& q, const std::optional<Box>& box) {
  const size_t naming = NamingAxis(q);
  const size_t other[2] = {(naming + 1) % 3, (naming + 2) % 3};
  std::vector<Int3> lines;
  for (int64_t level = 0; level < std::abs(q[naming]); ++level) {
    Interval range[2];
    for (size_t i = 0; i < 2; ++i) {
      range[i] = Shadow({triangle[0], triangle[1], triangle[2]}, q, naming, level, other[i]);
      if (!box || range[i].lo > range[i].hi) continue;
      const Interval seen = Shadow(Corners(*box), q, naming, level, other[i]);
      range[i] = {std::max(range[i].lo, seen.lo), std::min(range[i].hi, seen.hi)};
    }
    for (int64_t a = range[0].lo; a <= range[0].hi; ++a) {
      for (int64_t b = range[1].lo; b <= range[1].hi; ++b) {
        Int3 z{};
        z[naming] = level;
        z[other[0]] = a;
        z[other[1]] = b;
        lines.push_back(z);
      }
    }
  }
  return lines;
}

// A shifted triangle v0 + delta + u e1 + v e2 and a line 256 (z + s q), delta = (eps, eps^2, eps^3). They meet where
//   u e1 + v e2 - s Q = w,   Q = 256 q,   w = 256 z - v0 - delta,
// and Cramer's rule gives u, v and s as triple products over one common determinant.
class LineHitter {
 public:
  LineHitter(const Triangle& triangle, const Int3& q) : v0_(ToVector(triangle[0])) {
    const Vector e1 = ToVector(triangle[1]) - v0_;
    const Vector e2 = ToVector(triangle[2]) - v0_;
    const Vector minus_q = ToVector(q) * mpz_class(-kUnitsPerVoxel);
    for_u_ = Cross(e2, minus_q);
    for_v_ = Cross(minus_q, e1);
    for_s_ = Cross(e1, e2);
    determinant_ = Dot(e1, for_u_);
    orientation_ = -sgn(determinant_);
    if (sgn(determinant_) < 0) {
      determinant_ = -determinant_;
      for (Vector* v : {&for_u_, &for_v_, &for_s_}) *v = *v * mpz_class(-1);
    }
  }

  bool parallel() const { return sgn(determinant_) == 0; }
  int orientation() const { return orientation_; }

  // If the line through z meets the triangle: the integer part of s, and whether s is nearer to it than to the next
  // integer.
  struct Hit {
    int64_t floor;
    bool floor_is_nearer;
  };
  std::optional<Hit> Meet(const Int3& z) const {
    const Vector p = ToVector(z) * mpz_class(kUnitsPerVoxel) - v0_;
    // Most lines miss by more than the shift.
    if (Dot(for_u_, p) < 0 || Dot(for_v_, p) < 0) return std::nullopt;
    const Polynomial u = DotShifted(for_u_, p);
    if (Strict(u) < 0) return std::nullopt;
    const Polynomial v = DotShifted(for_v_, p);
    if (Strict(v) < 0) return std::nullopt;
    if (Strict(u + v - determinant_) > 0) return std::nullopt;

    const Polynomial s = DotShifted(for_s_, p);
    mpz_class floor;
    mpz_fdiv_q(floor.get_mpz_t(), s.c[0].get_mpz_t(), determinant_.get_mpz_t());
    if (Strict(s - floor * determinant_) < 0) --floor;
    const Polynomial part = s - floor * determinant_;
    Require(part.Sign() > 0 && (part - determinant_).Sign() < 0, "0 < fractional part < 1");
    Require(floor.fits_slong_p(), "a depth fits int64");
    return Hit{floor.get_si(), Strict(part * 2 - determinant_) < 0};
  }

 private:
  static int Strict(const Polynomial& p) {
    const int sign = p.Sign();
    Require(sign != 0, "the shift leaves no tie");
    return sign;
  }

  Vector v0_, for_u_, for_v_, for_s_;
  mpz_class determinant_;
  int orientation_;
};

// The other ends of each voxel's crossed edges.
std::map<Int3, std::vector<Int3>> OtherEnds(const std::set<Edge>& crossed) {
  std::map<Int3, std::vector<Int3>> ends;
  for (const Edge& edge : crossed) {
    ends[edge.a].push_back(edge.b);
    ends[edge.b].push_back(edge.a);
  }
  return ends;
}

bool CanLeave(const Int3& z, const std::set<Int3>& voxels, const std::map<Int3, std::vector<Int3>>& other_ends) {
  const auto found = other_ends.find(z);
  if (found == other_ends.end()) return true;
  return std::all_of(found->second.begin(), found->second.end(),
                     [&voxels](const Int3& other) { return voxels.contains(other); });
}

void Thin(const std::set<Edge>& crossed, std::set<Int3>& voxels) {
  const auto other_ends = OtherEnds(crossed);
  for (int64_t parity = 0; parity < 8; ++parity) {
    std::vector<Int3> leaving;
    for (const Int3& z : voxels) {
      const int64_t own = (z[0] & 1) << 2 | (z[1] & 1) << 1 | (z[2] & 1);
      if (own == parity && CanLeave(z, voxels, other_ends)) leaving.push_back(z);
    }
    for (const Int3& z : leaving) voxels.erase(z);
  }
}

}  // namespace

bool Box::Contains(const Int3& z) const {
  for (size_t axis = 0; axis < 3; ++axis) {
    if (z[axis] < lo[axis] || z[axis] > hi[axis]) return false;
  }
  return true;
}

Box Box::Grown(const Int3& margin) const { return {Step(lo, margin, -1), Step(hi, margin, 1)}; }

Edge MakeEdge(const Int3& z, const Int3& other) { return z < other ? Edge{z, other} : Edge{other, z}; }

std::vector<Crossing> Crossings(const Mesh& mesh, const Int3& q, const std::optional<Box>& box) {
  std::vector<Crossing> crossings;
  for (size_t index = 0; index < mesh.size(); ++index) {
    const LineHitter hitter(mesh[index], q);
    if (hitter.parallel()) continue;
    for (const Int3& line : CandidateLines(mesh[index], q, box)) {
      const auto hit = hitter.Meet(line);
      if (!hit) continue;
      const Int3 z = Step(line, q, hit->floor);
      const Int3 next = Step(z, q, 1);
      if (box && !box->Contains(z) && !box->Contains(next)) continue;
      crossings.push_back(
          {hit->floor_is_nearer ? z : next, hit->floor_is_nearer ? next : z, index, hitter.orientation()});
    }
  }
  return crossings;
}

std::set<Edge> CrossedEdges(const Mesh& mesh, const std::vector<Int3>& directions, const std::optional<Box>& box) {
  std::set<Edge> edges;
  for (const Int3& q : directions) {
    for (const Crossing& crossing : Crossings(mesh, q, box)) {
      edges.insert(MakeEdge(crossing.near_end, crossing.far_end));
    }
  }
  return edges;
}

Int3 LineOf(const Int3& z, const Int3& q) {
  const size_t axis = NamingAxis(q);
  const int64_t period = std::abs(q[axis]);
  const int64_t remainder = (z[axis] % period + period) % period;
  return Step(z, q, (remainder - z[axis]) / q[axis]);
}

// The reach of a voxel's fate. In its own pass, at worst the last, it depends on the neighbors that the seven passes
// before removed, and so on back. So it depends on membership before thinning, and on crossed links, of voxels at most
// 8 steps away. All of those have an end in the box grown by 8 steps.
std::set<Int3> Digitize(const Mesh& mesh, const std::vector<Int3>& directions, bool minimal,
                        const std::optional<Box>& box) {
  std::optional<Box> reach = box;
  if (box && minimal) {
    Int3 margin{};
    for (const Int3& q : directions) {
      for (size_t axis = 0; axis < 3; ++axis) margin[axis] = std::max(margin[axis], 8 * std::abs(q[axis]));
    }
    reach = box->Grown(margin);
  }
  std::set<Int3> voxels;
  std::set<Edge> crossed;
  for (const Int3& q : directions) {
    for (const Crossing& crossing : Crossings(mesh, q, reach)) {
      voxels.insert(crossing.near_end);
      crossed.insert(MakeEdge(crossing.near_end, crossing.far_end));
    }
  }
  if (minimal) Thin(crossed, voxels);
  if (box) std::erase_if(voxels, [&box](const Int3& z) { return !box->Contains(z); });
  return voxels;
}

size_t Tunnels(const std::set<Int3>& voxels, const std::set<Edge>& crossed) {
  return static_cast<size_t>(std::count_if(crossed.begin(), crossed.end(), [&voxels](const Edge& edge) {
    return !voxels.contains(edge.a) && !voxels.contains(edge.b);
  }));
}

size_t Redundant(const std::set<Int3>& voxels, const std::set<Edge>& crossed) {
  const auto other_ends = OtherEnds(crossed);
  return static_cast<size_t>(
      std::count_if(voxels.begin(), voxels.end(), [&](const Int3& z) { return CanLeave(z, voxels, other_ends); }));
}

// Everything times 512, so that t and the offset are integers: 2 * 256 * t = 256 * max |n.q|.
std::set<Int3> PlaneSet(Int3 normal, int64_t offset, const std::vector<Int3>& directions, const Box& box) {
  const auto first = std::find_if(normal.begin(), normal.end(), [](int64_t c) { return c != 0; });
  Require(first != normal.end(), "a normal is not zero");
  if (*first < 0) {
    normal = {-normal[0], -normal[1], -normal[2]};
    offset = -offset;
  }
  const Vector n = ToVector(normal);
  mpz_class t = 0;
  for (const Int3& q : directions) {
    const mpz_class reach = abs(Dot(n, ToVector(q))) * kUnitsPerVoxel;
    t = std::max(t, reach);
  }
  std::set<Int3> voxels;
  for (int64_t x = box.lo[0]; x <= box.hi[0]; ++x) {
    for (int64_t y = box.lo[1]; y <= box.hi[1]; ++y) {
      for (int64_t z = box.lo[2]; z <= box.hi[2]; ++z) {
        const mpz_class d = 2 * (kUnitsPerVoxel * Dot(n, ToVector({x, y, z})) - offset);
        if (-t < d && d <= t) voxels.insert({x, y, z});
      }
    }
  }
  return voxels;
}

}  // namespace latvox::oracle
