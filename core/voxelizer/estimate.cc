#include "core/voxelizer/estimate.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <type_traits>

#include "core/snap/mesh_range.h"
#include "core/voxelizer/world_box.h"

namespace latvox {
namespace {

// References into the mesh: copies as doubles, written one by one and read as vectors, take four times as long.
// Vertex: Vec3f or Vec3d.
template <class Vertex>
struct Corners {
  const Vertex &a, &b, &c;
};

template <class Vertex>
Vec3d Between(const Vertex& from, const Vertex& to) {
  return {double{to[0]} - from[0], double{to[1]} - from[1], double{to[2]} - from[2]};
}

double LengthOf(const Vec3d& v) { return std::sqrt(Dot(v, v)); }

template <class Vertex>
double TwiceAreaOf(const Corners<Vertex>& at) {
  return LengthOf(Cross(Between(at.a, at.b), Between(at.a, at.c)));
}

template <class Vertex>
double LengthAround(const Corners<Vertex>& at) {
  return LengthOf(Between(at.a, at.b)) + LengthOf(Between(at.b, at.c)) + LengthOf(Between(at.c, at.a));
}

// The volume of the corners' box with a margin, in voxels.
template <class Vertex>
double VolumeAround(const Corners<Vertex>& at, double size) {
  double volume = 1;
  for (size_t m = 0; m < 3; ++m) {
    const auto [low, high] = std::minmax({at.a[m], at.b[m], at.c[m]});
    volume *= (double{high} - low) / size + 4;
  }
  return volume;
}

template <class F>
double SumOver(const TriangleMesh& mesh, StopSignal stop, const F& f) {
  using Part = oneapi::tbb::blocked_range<size_t>;
  constexpr size_t kGrain = 16384;  // triangles for each task
  return VisitVertices(mesh, [&](const auto& vertices) {
    using Vertex = std::remove_cvref_t<decltype(vertices.front())>;
    return oneapi::tbb::parallel_deterministic_reduce(
        Part(0, mesh.triangles.size(), kGrain), 0.0,
        [&](const Part& part, double sum) {
          for (size_t t = part.begin(); t < part.end() && !stop.Stopped(); ++t) {
            const auto& [a, b, c] = mesh.triangles[t];
            sum += f(Corners<Vertex>{vertices[a], vertices[b], vertices[c]});
          }
          return sum;
        },
        std::plus<>());
  });
}

// The volume within `width` of a triangle: a prism on both sides, half a cylinder along each edge, a ball. World units.
template <class Vertex>
double VolumeWithin(const Corners<Vertex>& at, double width) {
  using std::numbers::pi;
  return width * (TwiceAreaOf(at) + pi / 2 * width * LengthAround(at) + pi * 4 / 3 * width * width);
}

double VolumeOf(const IndexBox& box) {
  double volume = 1;
  for (size_t m = 0; m < 3; ++m)
    volume *= std::max(0.0, static_cast<double>(box.max[m]) - static_cast<double>(box.min[m]));
  return volume;
}

// The interior of a surface, by the isoperimetric inequality.
double EstimateInterior(const MeshExtent& extent, double size, bool closed) {
  double volume = 1;
  for (size_t m = 0; m < 3; ++m) volume *= extent.bounds.max[m] - extent.bounds.min[m];
  const double ball = std::pow(extent.area, 1.5) / (6 * std::sqrt(std::numbers::pi));
  return (closed ? std::min(volume, ball) : volume) / (size * size * size);
}

}  // namespace

MeshExtent ExtentOf(const TriangleMesh& mesh, StopSignal stop) {
  const double twice_area = SumOver(mesh, stop, [](const auto& corners) { return TwiceAreaOf(corners); });
  return {BoundsOf(mesh, stop), twice_area / 2};
}

double EstimateVoxels(const TriangleMesh& mesh, const MeshExtent& extent, const Grid& grid, const VoxelRequest& request,
                      StopSignal stop) {
  const double size = grid.lattice.voxel_size();
  const auto grown = [&](const auto& corners) {
    return TwiceAreaOf(corners) / (size * size) + 2 * LengthAround(corners) / size + 1;
  };
  if (request.algorithm() != Algorithm::kExact) return SumOver(mesh, stop, grown);
  double voxels = request.is_supercover() ? SumOver(mesh, stop, grown) : 2 * extent.area / (size * size);
  if (request.band() != nullptr)
    voxels *= WidthOf(*request.band(), grid.lattice) / size;  // without the parts that neighboring triangles share
  if (request.solid() != nullptr) {
    voxels += EstimateInterior(extent, size, !request.solid()->force_open);
  }
  double delivered = request.part.region ? std::min(voxels, VolumeOf(*request.part.region)) : voxels;
  if (request.part.bounds) delivered = std::min(delivered, MostPointsIn(grid, *request.part.bounds));
  return request.part.shard ? delivered / request.part.shard->count : delivered;
}

// A line along k stands for a cell's volume over its length. Triangles face it in part, at most in full. Slivers meet
// more lines than their area suggests, but never more than their box of i and j holds, or than it has rows and columns.
double EstimateLineCrossings(const TriangleMesh& mesh, const Grid& grid, StopSignal stop) {
  const double size = grid.lattice.voxel_size(), step = LengthOf(grid.lattice.basis()[2]);
  const Mat3d& inverse = grid.lattice.inverse();
  const auto lines_along = [&](const auto& at, size_t m) {
    const auto coordinate = [&](const auto& v) {
      double sum = 0;
      for (size_t n = 0; n < 3; ++n) sum += inverse[n][m] * (double{v[n]} - grid.origin[n]);
      return sum;
    };
    const auto [low, high] = std::minmax({coordinate(at.a), coordinate(at.b), coordinate(at.c)});
    return std::max(std::floor(high) - std::ceil(low) + 1, 0.0);
  };
  return SumOver(mesh, stop, [&](const auto& corners) {
    const double rows = lines_along(corners, 0), columns = lines_along(corners, 1);
    return TwiceAreaOf(corners) * step / (size * size * size) + std::min(rows * columns, rows + columns);
  });
}

double EstimateVisits(const TriangleMesh& mesh, const Grid& grid, const VoxelRequest& request, double voxels,
                      StopSignal stop) {
  constexpr double kVisitsPerTriangle = 40;  // at 15 ns, the cost of a voxel otherwise
  if (request.is_supercover() || !request.fields.empty()) {
    return voxels + kVisitsPerTriangle * static_cast<double>(mesh.triangles.size());
  }
  if (request.band() != nullptr) {
    const double size = grid.lattice.voxel_size(), width = WidthOf(*request.band(), grid.lattice);
    const double volume = SumOver(mesh, stop, [&](const auto& corners) { return VolumeWithin(corners, width); });
    const double visits = volume / (size * size * size);
    return request.part.shard ? visits / request.part.shard->count : visits;
  }
  if (request.algorithm() != Algorithm::kBruteForce) return voxels;
  const double size = grid.lattice.voxel_size();
  return SumOver(mesh, stop, [&](const auto& corners) { return VolumeAround(corners, size); });
}

}  // namespace latvox
