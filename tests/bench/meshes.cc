#include "tests/bench/meshes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <type_traits>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/mesh_files/input.h"
#include "client/mesh_files/mesh_file.h"
#include "client/mesh_files/mesh_format.h"
#include "core/snap/mesh_range.h"
#include "server/decode/draco_decoder.h"
#include "tests/bench/parts.h"
#include "tests/bench/scene_file.h"
#include "tests/bench/shapes.h"
#include "tests/bench/wires.h"

namespace latvox {
namespace {

TriangleMesh Box() {
  // Returns three edges of equal length at right angles.
  constexpr std::array<Vec3f, 3> edges{{{-10, 2, 11}, {10, -5, 10}, {5, 14, 2}}};
  TriangleMesh mesh;
  for (unsigned corner = 0; corner < 8; ++corner) {
    Vec3f p{};
    for (size_t m = 0; m < 3; ++m) {
      if ((corner >> m & 1) != 0) p = p + edges[m];
    }
    mesh.vertices.push_back(p);
  }
  for (uint32_t m = 0; m < 3; ++m) {
    const uint32_t a = 1U << m, b = 1U << (m + 1) % 3, c = 1U << (m + 2) % 3;
    mesh.triangles.insert(mesh.triangles.end(), {{0, b, a}, {a, b, a | b}, {c, a | c, b | c}, {a | c, 7, b | c}});
  }
  return mesh;
}

// A sphere of rings: 4, 8, ... vertices from a pole to the equator, and back.
class Sphere {
 public:
  explicit Sphere(uint32_t half) : half_(half) {}

  TriangleMesh Make() {
    uint32_t above = AddRing(0);
    for (uint32_t ring = 1; ring <= 2 * half_; ++ring) {
      const uint32_t below = AddRing(ring);
      if (ring <= half_) {
        AddBelt(above, ring - 1, below, false);
      } else {
        AddBelt(below, 2 * half_ - ring, above, true);
      }
      above = below;
    }
    return std::move(mesh_);
  }

 private:
  // Adds a ring, and returns its first vertex.
  uint32_t AddRing(uint32_t ring) {
    const auto first = static_cast<uint32_t>(mesh_.vertices.size());
    const uint32_t count = VerticesOf(std::min(ring, 2 * half_ - ring));
    const double height = std::numbers::pi * ring / (2 * half_);
    for (uint32_t n = 0; n < count; ++n) {
      const double around = 2 * std::numbers::pi * n / count;
      mesh_.vertices.push_back({static_cast<float>(std::sin(height) * std::cos(around)),
                                static_cast<float>(std::sin(height) * std::sin(around)),
                                static_cast<float>(std::cos(height))});
    }
    return first;
  }

  // Adds the triangles between the ring of 4 n vertices from vertex `inner` on, and the ring of 4 n + 4 from `outer`
  // on.
  void AddBelt(uint32_t inner, uint32_t n, uint32_t outer, bool flipped) {
    const auto in = [&](uint32_t m) { return inner + m % VerticesOf(n); };
    const auto out = [&](uint32_t m) { return outer + m % VerticesOf(n + 1); };
    const auto add = [&](uint32_t a, uint32_t b, uint32_t c) {
      if (flipped) std::swap(b, c);
      mesh_.triangles.push_back({a, b, c});
    };
    for (uint32_t quarter = 0; quarter < 4; ++quarter) {
      const uint32_t i = quarter * n, o = quarter * (n + 1);
      for (uint32_t m = 0; m <= n; ++m) {
        add(in(i + m), out(o + m), out(o + m + 1));
        if (m < n) add(in(i + m), out(o + m + 1), in(i + m + 1));
      }
    }
  }

  static uint32_t VerticesOf(uint32_t n) { return std::max(4 * n, 1U); }

  const uint32_t half_;  // number of rings to the equator
  TriangleMesh mesh_;
};

TriangleMesh SphereOf(uint32_t triangles) {
  return Sphere(static_cast<uint32_t>(std::lround(std::sqrt(triangles / 8.0)))).Make();
}

// A mesh whose name ends in a number.
struct CountedMesh {
  absl::string_view before;
  uint32_t least, most;
  TriangleMesh (*make)(uint32_t);
};
constexpr CountedMesh kCountedMeshes[] = {{"sphere:", 8, 1U << 26, SphereOf}, {"wires:", 1, 1U << 20, Wires},
                                          {"forest:", 1, 1U << 24, Forest},   {"tangle:", 1, 1U << 24, Tangle},
                                          {"fan:", 3, 1U << 24, Fan},         {"cylinder:", 3, 1U << 24, Cylinder}};

absl::StatusOr<TriangleMesh> Counted(const CountedMesh& mesh, absl::string_view number) {
  uint32_t count = 0;
  if (!absl::SimpleAtoi(number, &count) || count < mesh.least || count > mesh.most) {
    return absl::InvalidArgumentError(
        absl::StrCat(mesh.before, number, ": not a number from ", mesh.least, " to ", mesh.most));
  }
  return mesh.make(count);
}

// Adds the midpoints of a mesh's edges as vertices.
class Midpoints {
 public:
  explicit Midpoints(TriangleMesh& mesh) : vertices_(mesh.vertices) { of_edge_.reserve(mesh.triangles.size() * 3 / 2); }

  uint32_t Of(uint32_t a, uint32_t b) {
    const auto [low, high] = std::minmax(a, b);
    const auto next = static_cast<uint32_t>(vertices_.size());
    const auto [entry, is_new] = of_edge_.try_emplace(uint64_t{low} << 32 | high, next);
    if (is_new) {
      Vec3f middle;
      for (size_t m = 0; m < 3; ++m) middle[m] = (vertices_[low][m] + vertices_[high][m]) / 2;
      vertices_.push_back(middle);
    }
    return entry->second;
  }

 private:
  PaddedVector<Vec3f>& vertices_;
  absl::flat_hash_map<uint64_t, uint32_t> of_edge_;
};

}  // namespace

absl::StatusOr<TriangleMesh> MeshNamed(const std::string& name) {
  if (name == "box") return Box();
  if (name == "ground") return Ground();
  if (auto parts = PartsNamed(name)) return *std::move(parts);
  for (const CountedMesh& counted : kCountedMeshes) {
    if (absl::string_view number = name; absl::ConsumePrefix(&number, counted.before)) return Counted(counted, number);
  }
  if (client::FormatOfPath(name) == client::MeshFormat::kDraco) {
    const auto bytes = client::ReadBytes(name);
    if (!bytes.ok()) return bytes.status();
    auto decoded = DecodeDraco(*bytes, Limits());
    if (!decoded.ok()) return decoded.status();
    return std::move(decoded->mesh);
  }
  if (absl::EndsWith(name, ".3ds")) return ReadSceneFile(name);
  auto mesh = client::ReadMesh(name);
  if (!mesh.ok()) return mesh.status();
  TriangleMesh out{{}, std::move(mesh->triangles)};
  for (const client::Vec3d& p : mesh->positions) {
    out.vertices.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  return out;
}

TriangleMesh Subdivided(TriangleMesh mesh, int times) {
  for (int n = 0; n < times; ++n) {
    Midpoints midpoints(mesh);
    std::vector<std::array<uint32_t, 3>> quarters;
    quarters.reserve(mesh.triangles.size() * 4);
    for (const auto& [a, b, c] : mesh.triangles) {
      const uint32_t ab = midpoints.Of(a, b), bc = midpoints.Of(b, c), ca = midpoints.Of(c, a);
      quarters.insert(quarters.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(quarters);
  }
  return mesh;
}

TriangleMesh Copied(TriangleMesh mesh, uint32_t count) {
  const auto vertices = static_cast<uint32_t>(mesh.vertex_count());
  const size_t triangles = mesh.triangles.size();
  const Bounds bounds = BoundsOf(mesh);
  const auto step = (bounds.max[0] - bounds.min[0]) / 2;
  for (uint32_t copy = 1; copy < count; ++copy) {
    const auto add = [&](auto& all) {
      for (size_t v = 0; v < vertices && !all.empty(); ++v) {
        auto moved = all[v];
        moved[0] += static_cast<std::remove_cvref_t<decltype(moved[0])>>(copy * step);
        all.push_back(moved);
      }
    };
    add(mesh.vertices);
    add(mesh.double_vertices);
    for (size_t t = 0; t < triangles; ++t) {
      const auto [a, b, c] = mesh.triangles[t];
      mesh.triangles.push_back({a + copy * vertices, b + copy * vertices, c + copy * vertices});
    }
  }
  return mesh;
}

}  // namespace latvox
