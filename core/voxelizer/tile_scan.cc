#include "core/voxelizer/tile_scan.h"

#include <algorithm>

#include "core/digitize/star.h"

namespace latvox {
namespace {

constexpr size_t kCancelInterval = 1024;  // triangles between two looks at `cancelled`

// A voxel that a triangle may contribute.
struct Candidate {
  Vec3i z;
  uint32_t triangle;
};

Triangle TriangleOf(const SnappedMesh& mesh, uint32_t index) {
  const auto& [v0, v1, v2] = mesh.triangles[index];
  return {mesh.vertices_lat[v0], mesh.vertices_lat[v1], mesh.vertices_lat[v2]};
}

// Whether no lattice edge with its nearer end in `box` can meet the triangle.
bool IsFarFrom(const Triangle& v, const IndexBox& box, const Vec3i& reach) {
  for (size_t m = 0; m < 3; ++m) {
    const auto [low, high] = std::minmax({v[0][m], v[1][m], v[2][m]});
    const int32_t half_step = reach[m] * kLatticeUnit / 2;
    if (high < box.min[m] * kLatticeUnit - half_step) return true;
    if (low > (box.max[m] - 1) * kLatticeUnit + half_step) return true;
  }
  return false;
}

// Calls f(triangle, index) for all triangles that are not far from the box, until the job is cancelled.
template <class F>
void ForEachTriangleNear(const TileContext& context, const std::vector<uint32_t>& triangles, const IndexBox& box,
                         F&& f) {
  for (size_t n = 0; n < triangles.size(); ++n) {
    if (n % kCancelInterval == 0 && context.cancelled) return;
    const Triangle triangle = TriangleOf(context.mesh, triangles[n]);
    if (!IsFarFrom(triangle, box, context.reach)) f(triangle, triangles[n]);
  }
}

// The voxels that may be an end of an edge that the triangle crosses: those within a step of it.
IndexBox WithinAStep(const Triangle& v, const Vec3i& reach, IndexBox box) {
  for (size_t m = 0; m < 3; ++m) {
    const auto [low, high] = std::minmax({v[0][m], v[1][m], v[2][m]});
    box.min[m] = std::max(box.min[m], ((low + kLatticeUnit - 1) >> kSubvoxelBits) - reach[m]);
    box.max[m] = std::min(box.max[m], (high >> kSubvoxelBits) + reach[m] + 1);
  }
  return box;
}

}  // namespace

// Half an edge beyond the outermost voxel that thinning looks at.
Vec3i TileContext::Margin() const { return reach * (minimal ? kThinHalo + 1 : 1); }

// Candidates wait until all triangles have set what they cross along their principal directions: most are set then.
void ScanBox(const TileContext& context, const std::vector<uint32_t>& triangles, const IndexBox& box, TileBox& set,
             std::vector<CrossedEdge>& edges) {
  const auto add = [&](const Vec3i& nearer, const Vec3i& farther) {
    const uint32_t end = set.IndexOf(nearer);
    set.Set(end);
    if (context.minimal && box.Contains(farther)) edges.push_back({end, set.IndexOf(farther)});
  };
  std::vector<Candidate> candidates;
  ForEachTriangleNear(context, triangles, box, [&](const Triangle& triangle, uint32_t index) {
    const OrientedTriangle oriented(triangle);
    if (oriented.normal == Vec<int64_t, 3>{}) return;
    ScanAlongPrincipal(oriented, PrincipalScanFrame(context.frames, oriented.normal), box, add, [&](const Vec3i& z) {
      if (!set.Test(set.IndexOf(z))) candidates.push_back({z, index});
    });
  });
  for (const auto& [z, index] : candidates) {
    if (set.Test(set.IndexOf(z))) continue;
    const OrientedTriangle oriented(TriangleOf(context.mesh, index));
    const Star star(oriented, z);
    for (const ScanFrame& scan : context.frames) {
      Vec3i step;
      if (!star.IsNearerEnd(scan.frame.q, step)) continue;
      add(z, z + step);
      break;
    }
  }
}

std::vector<CrossedEdge> EdgesAtRest(const TileContext& context, const std::vector<uint32_t>& triangles,
                                     const IndexBox& box, const TileBox& set, TileBox& rest) {
  std::vector<CrossedEdge> edges;
  ForEachTriangleNear(context, triangles, box, [&](const Triangle& triangle, uint32_t) {
    rest.ForEachIn(WithinAStep(triangle, context.reach, box), [&](const Vec3i& z, uint32_t end) {
      const OrientedTriangle oriented(triangle);
      const Star star(oriented, z);
      for (const ScanFrame& scan : context.frames) {
        Vec3i step;
        if (!star.IsEnd(scan.frame.q, step)) continue;
        const uint32_t other = set.IndexOf(z + step);
        if (!set.Test(other)) return rest.Clear(end);
        edges.push_back({end, other});
      }
    });
  });
  std::erase_if(edges, [&](const CrossedEdge& edge) { return !rest.Test(edge.end); });
  return edges;
}

}  // namespace latvox
