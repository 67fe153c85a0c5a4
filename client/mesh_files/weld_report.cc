#include "client/mesh_files/weld_report.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"

namespace latvox::client {
namespace {

// Returns for each vertex the first one at its position. Zeros of both signs are equal.
std::vector<uint32_t> FirstInPlace(const std::vector<Vec3d>& positions) {
  absl::flat_hash_map<Vec3d, uint32_t> first;
  std::vector<uint32_t> out;
  for (const Vec3d& position : positions) {
    out.push_back(first.try_emplace(position, static_cast<uint32_t>(out.size())).first->second);
  }
  return out;
}

// An edge, from the lower vertex to the higher. `forwards`: the triangle passes it in that direction.
struct Edge {
  std::pair<uint32_t, uint32_t> ends;
  bool forwards;
};

void CountEdges(std::vector<Edge> edges, WeldReport& report) {
  std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) { return e.ends < f.ends; });
  for (auto begin = edges.begin(); begin != edges.end();) {
    const auto is_other = [&](const Edge& edge) { return edge.ends != begin->ends; };
    const auto end = std::find_if(begin, edges.end(), is_other);
    report.open_edges += end - begin == 1;
    report.non_manifold_edges += end - begin > 2;
    report.inconsistent_edges += end - begin == 2 && begin[0].forwards == begin[1].forwards;
    begin = end;
  }
}

}  // namespace

WeldReport Weld(const Mesh& mesh) {
  WeldReport report;
  report.vertices = mesh.positions.size();
  report.triangles = mesh.triangles.size();
  const std::vector<uint32_t> first = FirstInPlace(mesh.positions);
  for (uint32_t v = 0; v < first.size(); ++v) report.duplicate_vertices += first[v] != v;
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const auto& [u, v, w] : mesh.triangles) {
    const std::array<uint32_t, 3> corners = {first[u], first[v], first[w]};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
      ++report.degenerate_triangles;
      continue;
    }
    for (size_t n = 0; n < 3; ++n) {
      const auto ends = std::minmax(corners[n], corners[(n + 1) % 3]);
      edges.push_back({ends, ends.first == corners[n]});
    }
  }
  CountEdges(std::move(edges), report);
  return report;
}

}  // namespace latvox::client
