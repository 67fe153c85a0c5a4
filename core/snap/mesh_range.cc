#include "core/snap/mesh_range.h"

#include <oneapi/tbb/blocked_range.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/base/metered.h"

namespace latvox {
namespace {

using Part = oneapi::tbb::blocked_range<size_t>;

constexpr size_t kGrain = 4096;  // vertices or triangles for each task

// 1 for each vertex that a triangle uses, else 0.
std::vector<uint8_t> UsedVertices(const TriangleMesh& mesh, StopSignal stop) {
  std::vector<uint8_t> used(mesh.vertex_count());
  MeteredFor(Part(0, mesh.triangles.size(), kGrain), [&](const Part& part) {
    if (stop.Stopped()) return;
    // Bytes may alias anything, pointers to them included, so these are copies. The marks are not read first, because
    // it is hard to predict whether one is set already.
    uint8_t* const marks = used.data();
    const std::span triangles(&mesh.triangles[part.begin()], part.size());
    for (const std::array<uint32_t, 3> triangle : triangles) {
      for (uint32_t index : triangle) std::atomic_ref(marks[index]).store(1, std::memory_order_relaxed);
    }
  });
  return used;
}

// The ranges of kBlock vertices each. Vertex: Vec3f or Vec3d.
template <class Vertex>
class BlockRanges {
 public:
  // The vertices that `used` marks; all if it is empty. Keeps references to the vertices and the map.
  BlockRanges(const PaddedVector<Vertex>& vertices, const LatticeMap& map, const std::vector<uint8_t>& used,
              StopSignal stop)
      : vertices_(vertices), map_(map), ranges_((vertices.size() + kBlock - 1) / kBlock) {
    MeteredFor(Part(0, ranges_.size(), kGrain / kBlock), [&](const Part& part) {
      for (size_t b = part.begin(); b < part.end() && !stop.Stopped(); ++b) ranges_[b] = RangeOfBlock(b * kBlock, used);
    });
    for (const LatticeRange& range : ranges_) all_.Add(range);
  }

  const LatticeRange& all() const { return all_; }

  // A vertex that attains all().*side on an axis, if all vertices count. Nullopt: none does, because numbers overflow.
  std::optional<uint32_t> VertexAt(Vec3d LatticeRange::*side, size_t axis) const {
    const auto attains = [&](const LatticeRange& range) { return (range.*side)[axis] == (all_.*side)[axis]; };
    const auto block = std::find_if(ranges_.begin(), ranges_.end() - 1, attains);
    size_t first = static_cast<size_t>(block - ranges_.begin()) * kBlock;
    size_t count = std::min(kBlock, vertices_.size() - first);
    while (count > 1) {
      const size_t half = count / 2;
      const bool before = attains(RangeOf(map_, &vertices_[first], half));
      first += before ? 0 : half;
      count = before ? half : count - half;
    }
    if (!attains(RangeOf(map_, &vertices_[first], 1))) return std::nullopt;
    return static_cast<uint32_t>(first);
  }

 private:
  static constexpr size_t kBlock = 1024;

  LatticeRange RangeOfBlock(size_t first, const std::vector<uint8_t>& used) const {
    const size_t size = std::min(kBlock, vertices_.size() - first);
    const Vertex* const vertices = &vertices_[first];
    if (used.empty()) return RangeOf(map_, vertices, size);
    std::array<Vertex, kBlock> counted;
    size_t count = 0;
    for (size_t n = 0; n < size; ++n) {
      counted[count] = vertices[n];
      count += used[first + n];
    }
    return RangeOf(map_, counted.data(), count);
  }

  const PaddedVector<Vertex>& vertices_;
  const LatticeMap& map_;
  std::vector<LatticeRange> ranges_;
  LatticeRange all_;
};

// Returns whether triangles certainly use all of these vertices, after a look at no more triangles than the mesh has.
// The search for a vertex begins at the nearest numbers of a sample, and goes farther and farther from there. Most
// meshes number vertices in the order of their triangles, at least in parts.
bool AreSeenUsed(const TriangleMesh& mesh, std::span<const uint32_t> vertices, StopSignal stop) {
  constexpr size_t kMostSamples = 4096, kLeastGap = 256, kStep = 2048;
  const std::span triangles(mesh.triangles);
  struct Nearest {
    size_t triangle = 0;
    int64_t distance = std::numeric_limits<int64_t>::max();
  };
  std::vector<Nearest> nearest(vertices.size());
  for (size_t t = 0; t < triangles.size(); t += std::max(triangles.size() / kMostSamples, kLeastGap)) {
    for (size_t n = 0; n < vertices.size(); ++n) {
      for (const uint32_t index : triangles[t]) {
        const int64_t distance = std::abs(int64_t{index} - vertices[n]);
        if (distance < nearest[n].distance) nearest[n] = {t, distance};
      }
    }
  }
  const std::span corners(triangles.front().data(), 3 * triangles.size());
  const auto is_used = [&](size_t first, size_t end, uint32_t vertex) {
    uint32_t used = 0;
    for (const uint32_t index : corners.subspan(3 * first, 3 * (end - first))) used |= index == vertex ? 1 : 0;
    return used != 0;
  };
  size_t searched = 0;  // triangles
  const auto is_found_from = [&](size_t center, uint32_t vertex) {
    size_t below = center, above = center;  // the part between them has been searched
    while ((below > 0 || above < triangles.size()) && searched <= triangles.size() && !stop.Stopped()) {
      const size_t lower = below - std::min(below, kStep), upper = std::min(above + kStep, triangles.size());
      if (is_used(lower, below, vertex) || is_used(above, upper, vertex)) return true;
      searched += (below - lower) + (upper - above);
      below = lower;
      above = upper;
    }
    return false;
  };
  for (size_t n = 0; n < vertices.size(); ++n) {
    if (!is_found_from(nearest[n].triangle, vertices[n])) return false;
  }
  return true;
}

}  // namespace

// It takes a pass over all triangles to mark used vertices, and is hardly ever necessary: where used vertices attain
// every extreme, the others change nothing.
LatticeRange RangeOf(const TriangleMesh& mesh, const LatticeMap& map, StopSignal stop) {
  return VisitVertices(mesh, [&](const auto& vertices) -> LatticeRange {
    const BlockRanges ranges(vertices, map, {}, stop);
    if (stop.Stopped()) return {};
    const auto of_used = [&] { return BlockRanges(vertices, map, UsedVertices(mesh, stop), stop).all(); };
    std::array<uint32_t, 6> extreme;
    for (size_t n = 0; n < 6; ++n) {
      const auto vertex = ranges.VertexAt(n < 3 ? &LatticeRange::min : &LatticeRange::max, n % 3);
      if (!vertex) return of_used();
      extreme[n] = *vertex;
    }
    return AreSeenUsed(mesh, extreme, stop) ? ranges.all() : of_used();
  });
}

Bounds BoundsOf(const TriangleMesh& mesh, StopSignal stop) {
  const LatticeMap world{{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {0, 0, 0}};
  const LatticeRange range = RangeOf(mesh, world, stop);
  return {range.min + Vec3d{}, range.max + Vec3d{}};  // no -0, which lanes may order differently from a scalar
}

}  // namespace latvox
