// Labeled bodies that touch and overlap, and their insides by the exact oracle.
#ifndef LATVOX_TESTS_UNIT_CORE_SOLID_LABELED_BODIES_H_
#define LATVOX_TESTS_UNIT_CORE_SOLID_LABELED_BODIES_H_

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/solid/line_fill.h"

namespace latvox {

inline const std::vector<uint32_t> kPriority = {40, 7, 1000000};  // no mesh has the last one

struct Bodies {
  oracle::Mesh mesh;
  std::vector<uint32_t> labels;  // of its triangles

  void Add(const oracle::Mesh& body, uint32_t label) {
    mesh.insert(mesh.end(), body.begin(), body.end());
    labels.resize(mesh.size(), label);
  }
  std::map<uint32_t, oracle::Mesh> ByLabel() const {
    std::map<uint32_t, oracle::Mesh> parts;
    for (size_t t = 0; t < mesh.size(); ++t) parts[labels[t]].push_back(mesh[t]);
    return parts;
  }
  TriangleMesh World(const Lattice& lattice, const Vec3i& shift) const {
    TriangleMesh world = ToWorld(mesh, lattice, shift);
    for (size_t n = 0; n < world.vertices.size(); ++n) world.attributes.push_back(labels[n / 3]);
    return world;
  }
};

inline oracle::Mesh Turned(oracle::Mesh mesh) {
  for (oracle::Triangle& triangle : mesh) std::swap(triangle[1], triangle[2]);
  return mesh;
}

// Faces through lattice points that two labels share, nested and overlapping ones, one body twice, one inside out, and
// the same body in two labels.
inline std::vector<Bodies> Adversaries() {
  Bodies touching, nested;
  touching.Add(Box({0, 0, 0}, {768, 1024, 1024}), 7);
  touching.Add(Box({768, 0, 0}, {1536, 1024, 1024}), 3);
  touching.Add(Box({0, 1024, 0}, {1536, 1300, 1024}), 40);
  touching.Add(Box({512, 512, 512}, {1100, 1280, 1536}), 5);
  nested.Add(Box({0, 0, 0}, {1600, 1600, 1600}), 2);
  nested.Add(Box({256, 256, 256}, {1344, 1344, 1344}), 1);
  nested.Add(Box({256, 256, 256}, {1344, 1344, 1344}), 7);
  nested.Add(Turned(Box({512, 300, 512}, {1100, 1100, 1100})), 7);
  nested.Add(Turned(Box({512, 512, 0}, {700, 700, 1600})), 9);
  nested.Add(Box({0, 0, 0}, {1600, 512, 512}), 2);
  std::vector<Bodies> all = {touching, nested};
  std::mt19937 random(17);
  for (int n = 0; n < 6; ++n) {
    const int64_t grain = n % 3 == 0 ? 256 : n % 3 == 1 ? 128 : 1;
    std::uniform_int_distribution<int64_t> coordinate(0, 6 * 256 / grain);
    Bodies bodies;
    for (int body = 0; body < 5; ++body) {
      std::array<Int3, 4> v;
      for (Int3& p : v) p = {coordinate(random) * grain, coordinate(random) * grain, coordinate(random) * grain};
      oracle::Mesh mesh;
      AddTetrahedron(v, random() % 4 == 0, mesh);
      if (random() % 3 == 0) AddTetrahedron(v, random() % 2 == 0, mesh);
      bodies.Add(mesh, std::array{7U, 3U, 40U}[random() % 3]);
    }
    all.push_back(bodies);
  }
  return all;
}

struct Expected {
  std::map<Int3, uint32_t> labels;  // of points inside
  uint64_t unbalanced = 0;
};

// Label by label, from the lowest priority up.
inline Expected Fill(const Bodies& bodies, InteriorRule rule, const std::vector<uint32_t>& priority) {
  Expected expected;
  std::vector<uint32_t> order;
  const auto parts = bodies.ByLabel();
  for (const auto& [label, mesh] : parts) {
    if (!std::ranges::count(priority, label)) order.push_back(label);
  }
  for (auto label = priority.rbegin(); label != priority.rend(); ++label) {
    if (parts.contains(*label)) order.push_back(*label);
  }
  for (const uint32_t label : order) {
    const LineFill fill = FillAlong(parts.at(label), {0, 0, 1}, rule);
    expected.unbalanced += fill.unbalanced;
    for (const Int3& z : fill.inside) expected.labels[z] = label;
  }
  return expected;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_SOLID_LABELED_BODIES_H_
