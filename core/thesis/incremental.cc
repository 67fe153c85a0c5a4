#include "core/thesis/incremental.h"

#include <cmath>

#include "core/thesis/active_edge_table.h"

namespace latvox {
namespace {

Vec<int64_t, 3> ToWide(const Vec3i& v) { return {v[0], v[1], v[2]}; }

// The triangle's plane in the frame (i, j, k) of its principal direction.
class ProjectedPlane {
 public:
  ProjectedPlane(const VoxelTriangle& triangle, const std::vector<Frame>& frames)
      : normal_(NormalOf(triangle)), frame_(PrincipalFrame(frames, normal_)) {
    for (size_t n = 0; n < 3; ++n) {
      const auto v = ToWide(triangle[n]);
      projected_[n] = {Dot(frame_.r[0], v), Dot(frame_.r[1], v)};
    }
    k0_ = Dot(frame_.r[2], ToWide(triangle[0]));
    for (size_t m = 0; m < 3; ++m) in_frame_[m] = Dot(normal_, frame_.u[m]);
  }

  ActiveEdgeTable Scan() const { return ActiveEdgeTable(projected_); }

  // Eq. 4.6 for P' = (i, j, 0). Up to a thousand voxels, integers below 2^53: the quotient is the only rounding, and a
  // half comes out as exactly a half.
  double OffsetAt(int64_t i, int64_t j) const {
    const int64_t drop = in_frame_[0] * (i - projected_[0][0]) + in_frame_[1] * (j - projected_[0][1]);
    return static_cast<double>(k0_) - static_cast<double>(drop) / static_cast<double>(in_frame_[2]);
  }
  // Eqs 4.10 and 4.11, m = 0, 1.
  double StepOfOffset(size_t m) const { return -static_cast<double>(in_frame_[m]) / static_cast<double>(in_frame_[2]); }

  // The lattice point of line (i, j) nearest to the plane. Along the line, distance to the plane is proportional to
  // distance in k; a half goes where the normal points.
  Vec3i VoxelAt(int64_t i, int64_t j, double offset) const {
    const double below = std::floor(offset), part = offset - below;
    const bool up = part == 0.5 ? in_frame_[2] > 0 : part > 0.5;
    const int64_t k = static_cast<int64_t>(below) + (up ? 1 : 0);
    Vec3i z;
    for (size_t m = 0; m < 3; ++m) {
      z[m] = static_cast<int32_t>(i * frame_.u[0][m] + j * frame_.u[1][m] + k * frame_.u[2][m]);
    }
    return z;
  }

 private:
  const Vec<int64_t, 3> normal_;
  const Frame& frame_;
  std::array<ActiveEdgeTable::Point, 3> projected_;  // (i, j) of the vertices
  int64_t k0_;                                       // k of the first
  Vec<int64_t, 3> in_frame_;                         // the normal: N.M_i, N.M_j, N.M_k
};

double DistanceSquared(const Mat3d& basis, const Vec3d& point, const Vec3i& z) {
  const Vec3d d = Apply(basis, point - ToDouble(z));
  return Dot(d, d);
}

}  // namespace

// A lattice point is nearest iff none of its facet neighbors is nearer (the point then lies in its Voronoi cell), so
// descent ends there. All other points at the same distance are its neighbors in N_0.
Vec3i NearestLatticePoint(const Lattice& lattice, const Vec3d& point) {
  const Mat3d& basis = lattice.basis();
  Vec3i nearest;
  for (size_t m = 0; m < 3; ++m) nearest[m] = static_cast<int32_t>(std::floor(point[m] + 0.5));
  double least = DistanceSquared(basis, point, nearest);
  for (bool moved = true; moved;) {
    moved = false;
    const Vec3i from = nearest;
    for (const auto& neighbor : lattice.neighbors()) {
      const Vec3i z = from + neighbor.w;
      const double distance = DistanceSquared(basis, point, z);
      if (distance < least || (distance == least && nearest < z)) {
        least = distance;
        nearest = z;
        moved = true;
      }
    }
  }
  return nearest;
}

Vec<int64_t, 3> NormalOf(const VoxelTriangle& triangle) {
  const auto normal = Cross(ToWide(triangle[1] - triangle[0]), ToWide(triangle[2] - triangle[0]));
  return FirstNonzeroIsPositive(normal) ? normal : -normal;
}

void IncrementalTriangle(const VoxelTriangle& triangle, const std::vector<Frame>& frames, StopSignal stop,
                         EmitVoxel emit) {
  const ProjectedPlane plane(triangle, frames);
  for (ActiveEdgeTable row = plane.Scan(); !row.done() && !stop.Stopped(); row.NextRow()) {
    for (int64_t i = row.first(); i <= row.last(); ++i) {
      emit(plane.VoxelAt(i, row.j(), plane.OffsetAt(i, row.j())));
    }
  }
}

void OptimizedIncrementalTriangle(const VoxelTriangle& triangle, const std::vector<Frame>& frames, StopSignal stop,
                                  EmitVoxel emit) {
  const ProjectedPlane plane(triangle, frames);
  const double step_i = plane.StepOfOffset(0), step_j = plane.StepOfOffset(1);
  ActiveEdgeTable row = plane.Scan();
  int64_t previous = row.first();
  double start = plane.OffsetAt(row.first(), row.j());
  for (; !row.done() && !stop.Stopped(); row.NextRow()) {
    start += static_cast<double>(row.first() - previous) * step_i;
    previous = row.first();
    double offset = start;
    for (int64_t i = row.first(); i <= row.last(); ++i) {
      emit(plane.VoxelAt(i, row.j(), offset));
      offset += step_i;
    }
    start += step_j;
  }
}

}  // namespace latvox
