// The parity of a closed mesh against the crossings of its links, from two requests of the core.
#ifndef LATVOX_TESTS_UNIT_CORE_FIELDS_LINKS_PARITY_H_
#define LATVOX_TESTS_UNIT_CORE_FIELDS_LINKS_PARITY_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <vector>

#include "core/fields/link_order.h"
#include "core/request/fields.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/fields.h"

namespace latvox {

// Parity tells the inside, by lines along k alone. Every neighbor of every point near the mesh is asked. Returns how
// many of these links are crossed an odd number of times.
//   force_open   for meshes that are closed for every line without sharing edges
inline size_t ExpectParity(const TriangleMesh& mesh, const Grid& grid, int k, bool force_open) {
  const std::vector<Vec3i> neighbors = NeighborsOf(grid.lattice.frames(k));
  const FieldList fields{Field::kLinkCrossings};
  const Result links = Voxelize(mesh, grid, {.separability = k, .set = Links{}, .fields = fields});
  std::map<oracle::Int3, std::vector<uint32_t>> crossings;
  for (const auto& [ijk, of_voxel] : FieldsByVoxel(links.tiles, fields, neighbors.size())) {
    std::vector<uint32_t>& numbers = crossings[ToOracle(ijk)];
    numbers.resize(neighbors.size());
    std::memcpy(numbers.data(), of_voxel[0].data(), of_voxel[0].size());
  }
  const Solid solid{.rule = InteriorRule::kParity, .surface = SolidSurface::kNone, .force_open = force_open};
  const std::set<oracle::Int3> inside = VoxelsOf(Voxelize(mesh, grid, {.set = solid}));
  std::set<oracle::Int3> asked = inside;
  for (const auto& [z, numbers] : crossings) asked.insert(z);
  size_t wrong = 0, odd = 0;
  for (const oracle::Int3& z : asked) {
    const bool is_inside = inside.contains(z);
    const auto at = crossings.find(z);
    for (size_t n = 0; n < neighbors.size(); ++n) {
      const Vec3i& q = neighbors[n];
      const bool differ = is_inside != inside.contains({z[0] + q[0], z[1] + q[1], z[2] + q[2]});
      const bool is_odd = at != crossings.end() && at->second[n] % 2 != 0;
      wrong += differ != is_odd ? 1 : 0;
      odd += is_odd ? 1 : 0;
    }
  }
  EXPECT_EQ(wrong, 0U);
  return odd;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_FIELDS_LINKS_PARITY_H_
