#include "core/fields/triangle_index.h"

#include <bit>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/base/sort.h"
#include "core/brick/tile_order.h"

namespace latvox {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Far more than the rounding errors of coordinates below 2^27 units.
constexpr double kPad = 0x1p-10;

float Below(double x) { return std::nextafter(static_cast<float>(x - kPad), -kInfinity); }
float Above(double x) { return std::nextafter(static_cast<float>(x + kPad), kInfinity); }

struct Keyed {
  uint64_t key;
  uint32_t triangle;
  bool operator<(const Keyed& other) const { return std::tie(key, triangle) < std::tie(other.key, other.triangle); }
};

// The place of a triangle's first corner along the curve, at a resolution of 2^21 a side.
uint64_t KeyOf(const Vec3i& corner) {
  constexpr int kShift = kEdgeBits + 1 - 21;
  return TileNumber(Shifted(corner, kShift));
}

}  // namespace

TriangleIndex::TriangleIndex(const SnappedMesh& mesh, const Metric& metric, StopSignal stop) {
  constexpr size_t kPiece = 4096;  // boxes between two looks at the stop signal
  Sort(mesh, stop);
  const size_t used = (order_.size() + kLeaf - 1) / kLeaf;
  leaves_ = std::bit_ceil(std::max(used, size_t{1}));
  boxes_.resize(2 * leaves_);
  for (size_t node = 2 * leaves_ - 1; node > 0; --node) {
    if (node % kPiece == 0 && stop.Stopped()) return;
    boxes_[node] =
        node >= leaves_ ? BoxOf(mesh, metric, node - leaves_) : Around(boxes_[2 * node], boxes_[2 * node + 1]);
  }
}

void TriangleIndex::Sort(const SnappedMesh& mesh, StopSignal stop) {
  std::vector<Keyed> keyed;
  keyed.reserve(mesh.triangles.size());
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % kSortedPiece == 0 && stop.Stopped()) return;
    keyed.push_back({KeyOf(mesh.vertices_lat[mesh.triangles[t][0]]), t});
  }
  latvox::Sort(keyed, stop);
  order_.reserve(keyed.size());
  for (size_t n = 0; n < keyed.size(); ++n) {
    if (n % kSortedPiece == 0 && stop.Stopped()) return;
    order_.push_back(keyed[n].triangle);
  }
}

TriangleIndex::Box TriangleIndex::Around(const Box& a, const Box& b) {
  Box box;
  for (size_t m = 0; m < 3; ++m) {
    box.low[m] = std::min(a.low[m], b.low[m]);
    box.high[m] = std::max(a.high[m], b.high[m]);
  }
  return box;
}

// Empty beyond the last triangle.
TriangleIndex::Box TriangleIndex::BoxOf(const SnappedMesh& mesh, const Metric& metric, size_t leaf) const {
  Box box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  const size_t end = std::min((leaf + 1) * kLeaf, order_.size());
  for (size_t n = leaf * kLeaf; n < end; ++n) {
    for (const Vec3i& corner : mesh.TriangleAt(order_[n])) {
      const Vec3d x = Apply(metric.root, ToDouble(corner));
      for (size_t m = 0; m < 3; ++m) {
        box.low[m] = std::min(box.low[m], Below(x[m]));
        box.high[m] = std::max(box.high[m], Above(x[m]));
      }
    }
  }
  return box;
}

void TriangleIndex::SetNumbers(const SnappedMesh& mesh, std::span<const uint32_t> of_vertices, size_t count,
                               StopSignal stop) {
  constexpr size_t kPiece = 4096;  // nodes between two looks at the stop signal
  of_vertices_ = of_vertices;
  count_ = count;
  vertices_.assign(2 * leaves_, kNone);
  for (size_t node = 2 * leaves_ - 1; node > 0; --node) {
    if (node % kPiece == 0 && stop.Stopped()) return;
    if (node < leaves_) {
      vertices_[node] = Merged(vertices_[2 * node], vertices_[2 * node + 1]);
      continue;
    }
    const size_t first = (node - leaves_) * kLeaf, end = std::min(first + kLeaf, order_.size());
    for (size_t n = first; n < end; ++n) {
      for (const uint32_t vertex : mesh.triangles[order_[n]]) vertices_[node] = Merged(vertices_[node], vertex);
    }
  }
}

uint32_t TriangleIndex::Merged(uint32_t vertex, uint32_t other) const {
  if (vertex == kNone || other == kMixed) return other;
  if (other == kNone || vertex == kMixed) return vertex;
  return AreEqual(vertex, &of_vertices_[other * count_]) ? vertex : kMixed;
}

bool TriangleIndex::MayFindOther(size_t node, const Vec3d& point, double bound, const uint32_t* numbers) const {
  const uint32_t vertex = vertices_[node];
  if (vertex == kNone || SquareTo(node, point, point) > bound) return false;
  if (vertex != kMixed) return !AreEqual(vertex, numbers);
  return node >= leaves_ || MayFindOther(2 * node, point, bound, numbers) ||
         MayFindOther(2 * node + 1, point, bound, numbers);
}

}  // namespace latvox
