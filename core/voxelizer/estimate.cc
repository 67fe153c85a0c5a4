#include "core/voxelizer/estimate.h"

#include <oneapi/tbb/blocked_range.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <type_traits>

#include "core/base/metered.h"
#include "core/brick/brick.h"
#include "core/snap/mesh_range.h"
#include "core/snap/snap.h"
#include "core/voxelizer/walk_estimate.h"
#include "core/voxelizer/world_box.h"

namespace latvox {
namespace {

// A unit of length: the power of two at or below the size of what is measured. In world units, an area's square would
// under- or overflow where sizes are beyond 2^-255 or 2^255. Products with powers of two are exact.
class Unit {
 public:
  explicit Unit(double size) {
    constexpr int kMost = 1000;  // so that 1 / unit is normal
    const int exponent = std::clamp(std::ilogb(size), -kMost, kMost);
    world_ = std::ldexp(1.0, exponent);
    per_world_ = std::ldexp(1.0, -exponent);
  }

  double In(double length) const { return length * per_world_; }
  double World(double length) const { return length * world_; }

 private:
  double world_, per_world_;
};

// References into the mesh: copies as doubles, written one by one and read as vectors, take four times as long.
// Vertex: Vec3f or Vec3d. Lengths and areas are in the unit.
template <class Vertex>
struct Corners {
  const Vertex &a, &b, &c;
  const Unit& unit;

  Vec3d Between(const Vertex& from, const Vertex& to) const {
    return {unit.In(double{to[0]} - from[0]), unit.In(double{to[1]} - from[1]), unit.In(double{to[2]} - from[2])};
  }
};

template <class Vertex>
double TwiceAreaOf(const Corners<Vertex>& at) {
  return LengthOf(Cross(at.Between(at.a, at.b), at.Between(at.a, at.c)));
}

template <class Vertex>
double LengthAround(const Corners<Vertex>& at) {
  return LengthOf(at.Between(at.a, at.b)) + LengthOf(at.Between(at.b, at.c)) + LengthOf(at.Between(at.c, at.a));
}

// The volume of the corners' box with a margin, in voxels. `size`: of a voxel, world units.
template <class Vertex>
double VolumeAround(const Corners<Vertex>& at, double size) {
  double volume = 1;
  for (size_t m = 0; m < 3; ++m) {
    const auto [low, high] = std::minmax({at.a[m], at.b[m], at.c[m]});
    volume *= (double{high} - low) / size + 4;
  }
  return volume;
}

template <class Vertex>
double LongestEdge(const Corners<Vertex>& at) {
  return std::max(
      {LengthOf(at.Between(at.a, at.b)), LengthOf(at.Between(at.b, at.c)), LengthOf(at.Between(at.c, at.a))});
}

// Reduces f(corners) over all triangles, always in the same order.
template <class Value, class F, class Join>
Value Reduce(const TriangleMesh& mesh, const Unit& unit, StopSignal stop, const F& f, const Join& join) {
  using Part = oneapi::tbb::blocked_range<size_t>;
  constexpr size_t kGrain = 16384;  // triangles for each task
  return VisitVertices(mesh, [&](const auto& vertices) {
    using Vertex = std::remove_cvref_t<decltype(vertices.front())>;
    return MeteredReduce(
        Part(0, mesh.triangles.size(), kGrain), Value{},
        [&](const Part& part, Value value) {
          for (size_t t = part.begin(); t < part.end() && !stop.Stopped(); ++t) {
            const auto& [a, b, c] = mesh.triangles[t];
            value = join(value, f(Corners<Vertex>{vertices[a], vertices[b], vertices[c], unit}));
          }
          return value;
        },
        join);
  });
}

template <class F>
double SumOver(const TriangleMesh& mesh, const Unit& unit, StopSignal stop, const F& f) {
  return Reduce<double>(mesh, unit, stop, f, std::plus<>());
}

// The volume within `width` of a triangle: a prism on both sides, half a cylinder along each edge, a ball.
template <class Vertex>
double VolumeWithin(const Corners<Vertex>& at, double width) {
  using std::numbers::pi;
  return width * (TwiceAreaOf(at) + pi / 2 * width * LengthAround(at) + pi * 4 / 3 * width * width);
}

// The sum of the volumes within `width` of each triangle, in voxels. `width` and `size`: world units.
double VolumesWithin(const TriangleMesh& mesh, double width, double size, StopSignal stop) {
  const Unit unit(size);
  const double in_unit = unit.In(size);
  return SumOver(mesh, unit, stop, [&](const auto& corners) { return VolumeWithin(corners, unit.In(width)); }) /
         (in_unit * in_unit * in_unit);
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
  for (size_t m = 0; m < 3; ++m) volume *= (extent.bounds.max[m] - extent.bounds.min[m]) / size;
  const double ball = std::pow(extent.area / (size * size), 1.5) / (6 * std::sqrt(std::numbers::pi));
  return closed ? std::min(volume, ball) : volume;
}

// A needle is longer than two voxels and thinner than one. Its rows cost as much as those of a thicker triangle, and
// each step that it crosses may find another voxel. So its area counts too little of both.
struct Needles {
  double length = 0;  // voxel sizes, in part where a needle is nearly as thick as a voxel
  double voxels = 0;  // besides those that the area counts
};

Needles FindNeedles(const TriangleMesh& mesh, const MeshExtent& extent, double size, StopSignal stop) {
  constexpr double kShortest = 2, kMoreVoxels = 3.5;  // the 13 steps of k = 0 meet 4.5 times what the area counts
  // Saves a pass over scans, and over meshes of well-shaped triangles.
  if (extent.longest <= kShortest * size || extent.thinnest >= size) return {};
  const Unit unit(size);
  const double in_unit = unit.In(size);
  const auto of_triangle = [in_unit](const auto& corners) -> Needles {
    const double length = LongestEdge(corners) / in_unit;
    const double thickness = TwiceAreaOf(corners) / (in_unit * in_unit) / length;
    if (length <= kShortest || thickness >= 1) return {};
    return {length * (1 - thickness), length * std::min(1 - thickness, kMoreVoxels * thickness)};
  };
  const auto join = [](const Needles& a, const Needles& b) {
    return Needles{a.length + b.length, a.voxels + b.voxels};
  };
  return Reduce<Needles>(mesh, unit, stop, of_triangle, join);
}

// The voxels that a job finds in the whole space; each counts once for each triangle.
double EstimateFound(const TriangleMesh& mesh, const MeshExtent& extent, const Grid& grid, const VoxelRequest& request,
                     const Needles& needles, StopSignal stop) {
  const double size = grid.lattice.voxel_size();
  double voxels = 2 * extent.area / (size * size) + needles.voxels;
  if (request.is_supercover() || request.algorithm() != Algorithm::kExact) {
    const Unit unit(size);
    voxels = SumOver(mesh, unit, stop, [in_unit = unit.In(size)](const auto& corners) {
      return TwiceAreaOf(corners) / (in_unit * in_unit) + 2 * LengthAround(corners) / in_unit + 1;
    });
  }
  if (request.links() != nullptr) voxels *= request.links()->side == LinkSide::kBoth ? 2 : 1;
  if (request.band() != nullptr)
    voxels *= WidthOf(*request.band(), grid.lattice) / size;  // without the parts that neighboring triangles share
  return voxels;
}

// All voxels that the mesh's box can hold.
double MostVoxels(const MeshExtent& extent, const Grid& grid) {
  double margin = 0;
  for (const Vec3d& step : grid.lattice.basis()) margin = std::max(margin, 2 * LengthOf(step));
  Bounds box = extent.bounds;
  for (size_t m = 0; m < 3; ++m) {
    box.min[m] -= margin;
    box.max[m] += margin;
  }
  return MostPointsIn(grid, box);
}

// The part of the voxels that the request asks for.
double Delivered(double voxels, const Grid& grid, const VoxelRequest& request) {
  if (request.part.region) voxels = std::min(voxels, VolumeOf(*request.part.region));
  if (request.part.bounds) voxels = std::min(voxels, MostPointsIn(grid, *request.part.bounds));
  return request.part.shard ? voxels / request.part.shard->count : voxels;
}

// The visits for the part of the voxels that the request asks for. A voxel of a surface counts once; where many
// triangles meet, a part has as many of the visits as it has of the box.
double VisitsOfPart(double visits, double most, const Grid& grid, const VoxelRequest& request) {
  const double part = Delivered(most, grid, request);
  return std::max(Delivered(visits, grid, request), visits * part / most);
}

// Where triangles fill a volume, thinning asks all triangles at nearly all voxels. On a surface it asks few. It asks
// most needles.
double VisitsOfThinning(double found, double most, const Needles& needles, const VoxelRequest& request) {
  constexpr double kVisitsPerVoxel = 20, kVisitsAlongNeedle = 8;  // at 15 ns
  if (!request.is_minimal()) return 0;
  const double share = std::min(found / most, 1.0);
  return kVisitsPerVoxel * share * share * found + kVisitsAlongNeedle * needles.length;
}

// Points inside of a label need no search if the label is all that they carry.
bool IsLabelAlone(const VoxelRequest& request) { return request.labels() && request.fields.OfNearest().size() == 1; }

// The search for the nearest triangles: an index of all triangles, and a walk through it for each voxel. Voxels far
// from the mesh have many triangles at nearly the same distance.
double VisitsOfFields(const TriangleMesh& mesh, double voxels, const VoxelRequest& request) {
  constexpr double kPerTriangle = 20, kPerVoxel = 100, kPerSolidVoxel = 1000;  // at 15 ns; in a band at 100 ns
  const bool is_band = request.band() != nullptr;
  const FieldList nearest = request.fields.OfNearest();
  if (nearest.empty() || (is_band && nearest == FieldList{Field::kDistance})) return 0;
  const bool is_far = request.is_filled() && !IsLabelAlone(request);
  const double per_voxel = is_far ? kPerSolidVoxel : kPerVoxel;
  return kPerTriangle * static_cast<double>(mesh.triangles.size()) + per_voxel * voxels;
}

// Whether the mesh must be closed, so that its area bounds what it encloses.
bool HasClosedMesh(const VoxelRequest& request) { return request.solid() != nullptr && !request.solid()->force_open; }

// Distances, in one or two scans; and the rows of the ball that reached points grow by, at each row of a tile.
double VisitsOfClosing(const TriangleMesh& mesh, const MeshExtent& extent, const WalkSet& walk, double size,
                       StopSignal stop) {
  constexpr double kScans = 2, kPerDistance = 4, kPerRow = 1.4;  // at 15 ns
  if (walk.close == 0) return 0;
  const double width = walk.close / 2, voxels = width / size;
  const double rows = std::numbers::pi * voxels * voxels * (extent.area / (size * size));
  return kScans * kPerDistance * VolumesWithin(mesh, width, size, stop) + kPerRow * rows;
}

// Links. Both ends of a link count as found, which covers the stars that are not left out; finding these stars takes
// time for each triangle. Fields of links need all stars. A voxel without a crossed link costs only the memory of its
// fields.
double VisitsOfLinks(const TriangleMesh& mesh, double found, double voxels, const VoxelRequest& request) {
  constexpr double kEndsPerTriangle = 5, kFieldsPerTriangle = 10, kPerCrossedVoxel = 15, kPerVoxel = 2;  // at 15 ns
  const auto triangles = static_cast<double>(mesh.triangles.size());
  double visits = request.links() != nullptr ? kEndsPerTriangle * triangles : 0;
  if (!request.fields.OfLinks().empty()) {
    visits += kPerCrossedVoxel * std::min(found, voxels) + kPerVoxel * voxels + kFieldsPerTriangle * triangles;
  }
  return visits;
}

// Fractions: the rows of finer tiles near the mesh, and the points of cells there. Each triangle is sorted into tiles.
// With labels, points near the mesh count for a few of them, and each voxel has a number for each, as many as there may
// be.
double VisitsOfFraction(const TriangleMesh& mesh, double found, double voxels, const VoxelRequest& request) {
  constexpr double kPerFinerPoint = 0.7, kPerTriangle = 30, kPerNumber = 0.2, kLabelsNearby = 2;  // at 15 ns
  if (request.fields.OfCells().empty()) return 0;
  const bool has_labels = request.fields.Contains(Field::kLabelFractions);
  const size_t listed = request.fraction_labels.size(), numbers = listed == 0 ? kMostFractionLabels : listed;
  const double per_voxel = kPerFinerPoint * request.fraction_n * request.fraction_n * (has_labels ? kLabelsNearby : 1);
  return per_voxel * std::min(2 * found, voxels) + kPerTriangle * static_cast<double>(mesh.triangles.size()) +
         (has_labels ? kPerNumber * static_cast<double>(numbers) * voxels : 0);
}

// The lattice coordinates that a job looks at. A part in world bounds has all points of a box around them.
IndexBox BoxOf(const Part& part, const Grid& grid) {
  constexpr int32_t kFar = 1 << 30;
  const IndexBox box = part.region.value_or(IndexBox{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}});
  return part.bounds && !IsEmpty(box) ? WorldBox(grid, *part.bounds).Around(box) : box;
}

// Crossings with lines along k, `spacing` voxels apart on i and j. A line along k stands for a cell's volume over its
// length. Triangles face it in part, at most in full. Slivers meet more lines than their area suggests, but never more
// than their box of i and j holds, or than it has rows and columns.
double CrossingsOfLines(const TriangleMesh& mesh, const Grid& grid, const IndexBox& box, double spacing,
                        StopSignal stop) {
  constexpr double kSnap = 1.0 / kLatticeUnit;  // the farthest that snapping moves a vertex
  const Unit unit(grid.lattice.voxel_size());
  const double size = unit.In(grid.lattice.voxel_size()), step = unit.In(LengthOf(grid.lattice.basis()[2]));
  const double of_area = step / (size * size * size) / (spacing * spacing);
  const Mat3d& inverse = grid.lattice.inverse();
  const auto lines_along = [&](const auto& at, size_t m) {
    const auto coordinate = [&](const auto& v) {
      double sum = 0;
      for (size_t n = 0; n < 3; ++n) sum += inverse[n][m] * (double{v[n]} - grid.origin[n]);
      return sum;
    };
    const auto [low, high] = std::minmax({coordinate(at.a), coordinate(at.b), coordinate(at.c)});
    const double first = std::max(low - kSnap, box.min[m] - spacing),
                 last = std::min(high + kSnap, box.max[m] + spacing);
    return std::max(std::floor(last / spacing) - std::ceil(first / spacing) + 1, 0.0);
  };
  return SumOver(mesh, unit, stop, [&](const auto& corners) {
    const double rows = lines_along(corners, 0);
    if (rows == 0) return 0.0;  // saves most of the time where triangles are small
    const double columns = lines_along(corners, 1);
    return std::min(rows * columns, TwiceAreaOf(corners) * of_area + rows + columns);
  });
}

}  // namespace

MeshExtent ExtentOf(const TriangleMesh& mesh, StopSignal stop) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  struct Sizes {
    double twice_area = 0, longest = 0, thinnest = kInfinity;
  };
  const auto of_triangle = [](const auto& corners) {
    const double twice_area = TwiceAreaOf(corners), longest = LongestEdge(corners);
    return Sizes{twice_area, longest, longest > 0 ? twice_area / longest : kInfinity};
  };
  const auto join = [](const Sizes& a, const Sizes& b) {
    return Sizes{a.twice_area + b.twice_area, std::max(a.longest, b.longest), std::min(a.thinnest, b.thinnest)};
  };
  const Bounds bounds = BoundsOf(mesh, stop);
  const Unit unit(bounds.LongestSide());
  const auto sizes = Reduce<Sizes>(mesh, unit, stop, of_triangle, join);
  return {bounds, unit.World(unit.World(sizes.twice_area / 2)), unit.World(sizes.longest), unit.World(sizes.thinnest)};
}

double EstimateVoxels(const TriangleMesh& mesh, const MeshExtent& extent, const Grid& grid, const VoxelRequest& request,
                      StopSignal stop) {
  const double size = grid.lattice.voxel_size();
  const Needles needles = FindNeedles(mesh, extent, size, stop);
  double voxels = EstimateFound(mesh, extent, grid, request, needles, stop);
  if (request.algorithm() != Algorithm::kExact) return voxels;
  if (request.is_filled()) voxels += EstimateInterior(extent, size, HasClosedMesh(request));
  return Delivered(voxels, grid, request);
}

double EstimateLineCrossings(const TriangleMesh& mesh, const Grid& grid, const VoxelRequest& request, StopSignal stop) {
  if (!request.needs_inside()) return 0;
  const bool may_be_open = request.solid() != nullptr && request.solid()->force_open;
  const IndexBox box = BoxOf(request.part, grid);
  const double crossings = may_be_open ? CrossingsOfLines(mesh, grid, BoxOf({}, grid), 1, stop)
                                       : CrossingsOfLines(mesh, grid, box, kTileSide, stop);
  if (request.fields.OfCells().empty()) return crossings;
  return crossings + CrossingsOfLines(mesh, grid, box, double{kTileSide} / request.fraction_n, stop);
}

// As measured, at 15 ns. With `close`, a tile also has distances and a ball's rows.
double WithPreparation(double visits, const VoxelRequest& request, double line_crossings, double wall_tiles) {
  constexpr double kPerCrossing = 6, kPerTile = 4000, kPerClosedTile = 10000;
  const bool closes = request.walk() != nullptr && request.walk()->close > 0;
  return std::max(visits, kPerCrossing * line_crossings + (closes ? kPerClosedTile : kPerTile) * wall_tiles);
}

// A visit of a band finds a distance.
double EstimateMilliseconds(const VoxelRequest& request, uint64_t triangles, double visits) {
  constexpr double kPerTriangle = 50e-6, kPerVisit = 15e-6, kPerVisitOfABand = 100e-6;
  return kPerTriangle * static_cast<double>(triangles) +
         (request.band() == nullptr ? kPerVisit : kPerVisitOfABand) * visits;
}

double EstimateVisits(const TriangleMesh& mesh, const MeshExtent& extent, const Grid& grid, const VoxelRequest& request,
                      StopSignal stop) {
  // At 15 ns, the cost of a voxel otherwise: some 100 instructions on AVX2.
  constexpr double kVisitsPerTriangle = 2;   // of a supercover, besides the cells that it touches
  constexpr double kVisitsAlongNeedle = 12;  // for each voxel size of its length, because its rows have few voxels
  constexpr double kVisitsOfWalk = 1e4;      // of a label: with 1000 small parts, a million instructions each
  const double size = grid.lattice.voxel_size();
  if (request.band() != nullptr) {
    const double width = WidthOf(*request.band(), grid.lattice);
    const double visits = VolumesWithin(mesh, width, size, stop);
    const double found = EstimateFound(mesh, extent, grid, request, {}, stop);
    const double delivered = Delivered(found, grid, request);
    return (request.part.shard ? visits / request.part.shard->count : visits) +
           VisitsOfFields(mesh, delivered, request) + VisitsOfLinks(mesh, found, delivered, request) +
           VisitsOfFraction(mesh, found, delivered, request);
  }
  if (request.algorithm() == Algorithm::kBruteForce) {
    return SumOver(mesh, Unit(size), stop, [&](const auto& corners) { return VolumeAround(corners, size); });
  }
  const Needles needles = FindNeedles(mesh, extent, size, stop);
  const double found = EstimateFound(mesh, extent, grid, request, needles, stop);
  if (request.algorithm() != Algorithm::kExact) return found;
  double visits = found + kVisitsAlongNeedle * needles.length;
  const double most = MostVoxels(extent, grid);
  visits += VisitsOfThinning(found, most, needles, request);
  const double of_surface = visits;
  if (request.is_filled()) visits += EstimateInterior(extent, size, HasClosedMesh(request));
  visits = VisitsOfPart(visits, most, grid, request);
  if (request.walk() != nullptr) visits += of_surface + VisitsOfClosing(mesh, extent, *request.walk(), size, stop);
  if (request.walk() != nullptr && request.labels()) visits += kVisitsOfWalk * MostWalks(mesh, request, stop);
  if (request.is_supercover()) visits += kVisitsPerTriangle * static_cast<double>(mesh.triangles.size());
  if (request.fields.empty() && request.links() == nullptr) return visits;
  const double ends = Delivered(found, grid, request);
  const double voxels = EstimateVoxels(mesh, extent, grid, request, stop);
  visits += VisitsOfLinks(mesh, ends, voxels, request) + VisitsOfFraction(mesh, ends, voxels, request);
  if (IsLabelAlone(request)) {  // each voxel of a labeled walk has a label
    return visits + (request.has_surface() && request.walk() == nullptr ? VisitsOfFields(mesh, ends, request) : 0);
  }
  return visits + VisitsOfFields(mesh, voxels, request);
}

}  // namespace latvox
