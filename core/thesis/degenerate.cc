#include "core/thesis/degenerate.h"

#include <algorithm>
#include <utility>

namespace latvox {
namespace {

// The squared distance of a world vector from the line through 0 along `line`, times |line|^2.
double ErrorOf(const Vec3d& point, const Vec3d& line) {
  const Vec3d area = Cross(point, line);
  return Dot(area, area);
}

}  // namespace

// Every direction lies in a cone of three k-neighbors that span the lattice. The Delaunay cells around a lattice point
// have facet neighbors as edges. In three dimensions, their tetrahedra always have the smallest possible volume.
LineTracer::LineTracer(const Neighborhood& neighborhood) : basis_(neighborhood.lattice.basis()) {
  for (const Frame& frame : neighborhood.frames) {
    neighbors_.push_back(frame.q);
    neighbors_.push_back(-frame.q);
  }
  std::sort(neighbors_.begin(), neighbors_.end());
  const auto length2 = [this](const Vec3i& q) {
    const Vec3d step = Apply(basis_, q);
    return Dot(step, step);
  };
  for (const Vec3i& q1 : neighbors_) {
    for (const Vec3i& q2 : neighbors_) {
      for (const Vec3i& q3 : neighbors_) {
        // Each set of three occurs once with a positive orientation and its smallest member first.
        if (!(q1 < q2 && q1 < q3) || Determinant(Mat<int32_t, 3>{q1, q2, q3}) != 1) continue;
        steps_.push_back(
            {{q1, q2, q3}, {Cross(q2, q3), Cross(q3, q1), Cross(q1, q2)}, {length2(q1), length2(q2), length2(q3)}});
      }
    }
  }
}

void LineTracer::Trace(const Vec3i& a, const Vec3i& b, EmitVoxel emit) const {
  const Vec3i from = std::min(a, b), difference = std::max(a, b) - from;
  // Most triangles that rounding collapses span one step.
  if (std::binary_search(neighbors_.begin(), neighbors_.end(), difference)) {
    emit(from);
    emit(from + difference);
    return;
  }
  const Vec3l wide{difference[0], difference[1], difference[2]};
  const Steps* best = nullptr;
  Vec3l left{};
  double least_length2 = 0;
  for (const Steps& steps : steps_) {
    const Vec3l counts{Dot(steps.inverse[0], wide), Dot(steps.inverse[1], wide), Dot(steps.inverse[2], wide)};
    if (std::min({counts[0], counts[1], counts[2]}) < 0) continue;
    const int64_t more = best == nullptr ? -1 : counts[0] + counts[1] + counts[2] - (left[0] + left[1] + left[2]);
    const Vec3d as_double{static_cast<double>(counts[0]), static_cast<double>(counts[1]),
                          static_cast<double>(counts[2])};
    const double length2 = Dot(as_double, steps.length2);
    if (more > 0 || (more == 0 && length2 >= least_length2)) continue;
    best = &steps;
    left = counts;
    least_length2 = length2;
  }
  const Vec3d line = Apply(basis_, difference);
  Vec3i z = from;
  emit(z);
  while (left[0] + left[1] + left[2] > 0) {
    size_t next = 3;
    double least = 0;
    for (size_t n = 0; n < 3; ++n) {
      if (left[n] == 0) continue;
      const double error = ErrorOf(Apply(basis_, z + best->q[n] - from), line);
      if (next < 3 && (error > least || (error == least && best->q[next] < best->q[n]))) continue;
      next = n;
      least = error;
    }
    --left[next];
    z = z + best->q[next];
    emit(z);
  }
}

void DegenerateTriangle(const VoxelTriangle& triangle, const LineTracer& tracer, EmitVoxel emit) {
  // On a line, lexicographic order is the order along it.
  const auto [low, high] = std::minmax({triangle[0], triangle[1], triangle[2]});
  tracer.Trace(low, high, emit);
}

}  // namespace latvox
