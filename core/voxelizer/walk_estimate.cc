#include "core/voxelizer/walk_estimate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/brick/label_runs.h"
#include "core/request/labels.h"
#include "core/walk/steps.h"

namespace latvox {
namespace {

constexpr size_t kPiece = 4096;  // vertices or triangles between two looks at the stop signal

// How far walls and their tiles are from the mesh.
struct WallRoom {
  double width;        // half of `close`, world units
  Vec3d closed, step;  // voxels along each lattice axis: of `width`; of the steps, and of the blocks that are looked at
  Vec3d margin() const { return closed + step; }
};

// A wall is within half a step or `width` of the mesh. A tile looks one step around itself. Where basis vectors are no
// steps, the other tiles of a block count as well. Snapping and rounding take less than a voxel.
WallRoom RoomOf(const Grid& grid, const VoxelRequest& request) {
  const WalkSteps steps = MakeWalkSteps(grid.lattice.frames(request.separability));
  const double half = request.walk()->close / 2;
  WallRoom room{half, {}, {}};
  const bool sees_blocks = steps.slack != Vec3i{};
  for (size_t m = 0; m < 3; ++m) {
    const Mat3d& inverse = grid.lattice.inverse();
    room.closed[m] = half * LengthOf({inverse[0][m], inverse[1][m], inverse[2][m]});
    room.step[m] = 4 * steps.reach[m] + steps.slack[m] + (sees_blocks ? kTileSide : 0) + 2;
  }
  return room;
}

// The longest diagonal of a cell with sides of so many basis vectors, world units.
double DiagonalOf(const Grid& grid, const Vec3d& sides) {
  const Mat3d& basis = grid.lattice.basis();
  const Vec3d a = basis[0] * sides[0], b = basis[1] * sides[1], c = basis[2] * sides[2];
  return std::max({LengthOf(a + b + c), LengthOf(a + b - c), LengthOf(a - b + c), LengthOf(b + c - a)});
}

// A box in lattice coordinates.
struct LatticeBox {
  Vec3d low, high;

  // The cells of so many voxels a side that it meets, per axis.
  double CellsAlong(size_t m, double side) const { return std::floor(high[m] / side) - std::floor(low[m] / side) + 1; }
  double Cells(double side) const { return CellsAlong(0, side) * CellsAlong(1, side) * CellsAlong(2, side); }
};

// A box of tiles, its last ones included.
struct TileBox {
  Vec3i low, high;

  // The cubes that it meets. A cube has 2^level tiles along each axis.
  TileBox Cubes(int level) const { return {Shifted(low, level), Shifted(high, level)}; }

  double size() const {
    double size = 1;
    for (size_t m = 0; m < 3; ++m) size *= static_cast<double>(high[m]) - low[m] + 1;
    return size;
  }

  bool operator==(const TileBox&) const = default;
};

// A set of cubes of tiles. Cubes double their sides before they are too many, so the memory is bounded.
class Cubes {
 public:
  Cubes(int level, StopSignal stop) : level_(level), stop_(stop) {}

  int level() const { return level_; }

  // Adds all cubes that the box meets. Precondition: the set has at most kMaxWalkLabels labels, so that it is small
  // enough when all tiles of a label are in eight cubes.
  void Add(uint32_t label, const TileBox& box) {
    const TileBox cubes = box.Cubes(level_);
    if (label == last_label_ && cubes == last_) return;  // triangles that follow each other mostly are neighbors
    last_label_ = label;
    last_ = cubes;
    for (int32_t i = cubes.low[0]; i <= cubes.high[0]; ++i) {
      for (int32_t j = cubes.low[1]; j <= cubes.high[1]; ++j) {
        for (int32_t k = cubes.low[2]; k <= cubes.high[2]; ++k) cubes_.insert({label, Vec3i{i, j, k}});
      }
    }
    while (cubes_.size() > kMost && !stop_.Stopped()) Double();
  }

  double Tiles() const { return static_cast<double>(cubes_.size()) * std::pow(8.0, level_); }

 private:
  static constexpr size_t kMost = size_t{1} << 18;
  static_assert(8 * kMaxWalkLabels <= kMost);

  void Double() {
    absl::flat_hash_set<std::pair<uint32_t, Vec3i>> doubled;
    for (const auto& [label, cube] : cubes_) doubled.insert({label, Shifted(cube, 1)});
    cubes_ = std::move(doubled);
    ++level_;
    last_ = kNone;
  }

  static constexpr TileBox kNone{{0, 0, 0}, {-1, -1, -1}};

  int level_;
  const StopSignal stop_;
  absl::flat_hash_set<std::pair<uint32_t, Vec3i>> cubes_;
  uint32_t last_label_ = 0;
  TileBox last_ = kNone;
};

// The level of cubes that are as wide as the margin, so that small triangles meet few of them.
int LevelFor(const Vec3d& margin) {
  const double widest = *std::max_element(margin.begin(), margin.end());
  int level = 0;
  while (level < 16 && double{kTileSide} * (1 << level) < widest) ++level;
  return level;
}

// The place of the labels among the numbers of a vertex.
size_t PlaceOfLabels(const VoxelRequest& request) {
  const FieldList of_mesh = request.fields.OfMesh();
  return static_cast<size_t>(std::ranges::find(of_mesh, request.labels()->field) - of_mesh.begin());
}

// Adds up the tiles of triangles in several ways. Each is an upper bound.
class WallTiles {
 public:
  WallTiles(const Grid& grid, const VoxelRequest& request, StopSignal stop)
      : grid_(grid),
        room_(RoomOf(grid, request)),
        margin_(room_.margin()),
        cubes_(LevelFor(margin_), stop),
        first_level_(cubes_.level()),
        side_(kTileSide * grid.lattice.voxel_size()) {
    // From any point of the tile to one of the wall, and from there to the mesh.
    const Vec3d tile{kTileSide, kTileSide, kTileSide};
    width_ = (room_.width + DiagonalOf(grid, tile + room_.step)) / side_;
  }

  template <class Vertex>
  void Add(uint32_t label, const Vertex& a, const Vertex& b, const Vertex& c) {
    constexpr double kPoint = 27;  // tiles: about the least volume, that around a point
    constexpr double kFewCubes = 64;
    const TileBox box = Around({InLattice(a), InLattice(b), InLattice(c)});
    double tiles = box.size();
    if (tiles > kPoint) tiles = std::min(tiles, VolumeWithin(a, b, c));
    sum_ += tiles;
    if (box.Cubes(first_level_).size() > kFewCubes) {
      of_large_ += tiles;
    } else {
      cubes_.Add(label, box);
    }
  }

  double Most() const { return std::min(sum_, of_large_ + cubes_.Tiles()); }

 private:
  TileBox Around(const std::array<Vec3d, 3>& points) const {
    TileBox box;
    for (size_t m = 0; m < 3; ++m) {
      const auto [low, high] = std::minmax({points[0][m], points[1][m], points[2][m]});
      box.low[m] = TileAt(low - margin_[m]);
      box.high[m] = TileAt(high + margin_[m]);
    }
    return box;
  }

  // std::floor is a call without SSE4.1, and takes most of the time. A job refuses a mesh that reaches farther.
  static int32_t TileAt(double x) {
    constexpr double kFar = 0x1p30;
    const double bounded = x >= -kFar ? std::min(x, kFar) : -kFar;  // also not a number
    const auto towards_zero = static_cast<int32_t>(bounded);
    const int32_t rounded_down = towards_zero - (bounded < towards_zero ? 1 : 0);
    return rounded_down >> kTileBits;
  }

  template <class Vertex>
  Vec3d InLattice(const Vertex& v) const {
    return Apply(grid_.lattice.inverse(), Vec3d{v[0], v[1], v[2]} - grid_.origin);
  }

  // A prism on both sides, half a cylinder along each edge, and a ball. In tiles, because in world units an area's
  // square may under- or overflow.
  template <class Vertex>
  double VolumeWithin(const Vertex& a, const Vertex& b, const Vertex& c) const {
    using std::numbers::pi;
    const Vec3d p{a[0], a[1], a[2]};
    const Vec3d e = InTiles(Vec3d{b[0], b[1], b[2]} - p), f = InTiles(Vec3d{c[0], c[1], c[2]} - p);
    const double around = LengthOf(e) + LengthOf(f) + LengthOf(f - e);
    return width_ * (LengthOf(Cross(e, f)) + pi / 2 * width_ * around + pi * 4 / 3 * width_ * width_);
  }

  Vec3d InTiles(const Vec3d& v) const { return {v[0] / side_, v[1] / side_, v[2] / side_}; }

  const Grid& grid_;
  const WallRoom room_;
  const Vec3d margin_;
  Cubes cubes_;
  const int first_level_;  // of the cubes
  const double side_;      // of a tile of so many voxels, world units
  double width_ = 0;       // the same sides
  double sum_ = 0, of_large_ = 0;
};

// The box around the mesh's bounds in lattice coordinates, widened by a margin.
LatticeBox BoxOf(const Bounds& bounds, const Grid& grid, const Vec3d& margin) {
  const Mat3d& inverse = grid.lattice.inverse();
  LatticeBox box;
  for (size_t m = 0; m < 3; ++m) {
    double low = -margin[m], high = margin[m];
    for (size_t c = 0; c < 3; ++c) {
      const auto [least, most] = std::minmax(
          {inverse[c][m] * (bounds.min[c] - grid.origin[c]), inverse[c][m] * (bounds.max[c] - grid.origin[c])});
      low += least;
      high += most;
    }
    box.low[m] = low;
    box.high[m] = high;
  }
  return box;
}

}  // namespace

double MostWalks(const TriangleMesh& mesh, const VoxelRequest& request, StopSignal stop) {
  if (request.walk() == nullptr) return 0;
  const std::optional<LabelRequest> labels = request.labels();
  if (!labels) return 1;
  const size_t stride = request.fields.OfMesh().size();
  absl::flat_hash_set<uint32_t> numbers;
  uint32_t last = kNoLabel;
  size_t vertex = 0;
  for (size_t n = PlaceOfLabels(request); n < mesh.attributes.size() && numbers.size() < labels->most; n += stride) {
    if (vertex++ % kPiece == 0 && stop.Stopped()) return 0;
    if (mesh.attributes[n] != last) numbers.insert(mesh.attributes[n]);
    last = mesh.attributes[n];
  }
  return static_cast<double>(numbers.size());
}

double MostWallTiles(const TriangleMesh& mesh, const MeshExtent& extent, const Grid& grid, const VoxelRequest& request,
                     double walks, StopSignal stop) {
  if (request.walk() == nullptr) return 0;
  constexpr double kFewTiles =
      1 << 10;  // a grid of 512^3; without `close` they take 25 MB, and a pass saves some of it
  const double in_box = BoxOf(extent.bounds, grid, RoomOf(grid, request).margin()).Cells(kTileSide) * walks;
  if (request.walk()->close == 0 && in_box <= kFewTiles) return in_box;
  const size_t stride = request.fields.OfMesh().size(), place = request.labels() ? PlaceOfLabels(request) : 0;
  const bool has_labels = request.labels() && mesh.attributes.size() == mesh.vertex_count() * stride;
  const auto number = [&](uint32_t vertex) { return has_labels ? mesh.attributes[vertex * stride + place] : 0; };
  WallTiles tiles(grid, request, stop);
  absl::flat_hash_set<uint32_t> labels;
  uint32_t last = kNoLabel;
  const bool is_whole = VisitVertices(mesh, [&](const auto& vertices) {
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
      if (t % kPiece == 0 && stop.Stopped()) return false;
      const auto& [a, b, c] = mesh.triangles[t];
      const uint32_t label = std::min({number(a), number(b), number(c)});
      if (label != last && labels.insert(label).second && labels.size() > kMaxWalkLabels) return false;
      last = label;
      tiles.Add(label, vertices[a], vertices[b], vertices[c]);
    }
    return true;
  });
  return is_whole ? std::min(tiles.Most(), in_box) : in_box;
}

double MostWalkPoints(const MeshExtent& extent, const Grid& grid, const VoxelRequest& request) {
  if (request.walk() == nullptr) return 0;
  return BoxOf(extent.bounds, grid, RoomOf(grid, request).margin()).Cells(1);
}

}  // namespace latvox
