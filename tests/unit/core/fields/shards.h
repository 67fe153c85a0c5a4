// All parts of a job together.
#ifndef LATVOX_TESTS_UNIT_CORE_FIELDS_SHARDS_H_
#define LATVOX_TESTS_UNIT_CORE_FIELDS_SHARDS_H_

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

#include "tests/unit/core/exact.h"

namespace latvox {

inline JobTotals TotalsOfShards(const TriangleMesh& mesh, const Grid& grid, VoxelizeOptions options, uint32_t count) {
  JobTotals sum;
  for (uint32_t index = 0; index < count; ++index) {
    options.shard = Shard{index, count};
    sum.Add(Voxelize(mesh, grid, options).totals);
  }
  return sum;
}

// Those of the first half of a job's tiles, and of a job that resumes after it.
inline JobTotals TotalsOfHalves(const TriangleMesh& mesh, const Grid& grid, VoxelizeOptions options,
                                const Result& whole) {
  JobTotals sum;
  const size_t half = whole.tiles.size() / 2;
  for (size_t n = 0; n < half; ++n) sum.Add(whole.tiles[n]);
  options.resume_after = whole.tiles[half - 1].tile_ijk;
  sum.Add(Voxelize(mesh, grid, options).totals);
  return sum;
}

// Three shards, and both halves, have the voxels and the digests of the whole.
inline void ExpectPartsAddUp(const TriangleMesh& mesh, const Grid& grid, const VoxelizeOptions& options,
                             const Result& whole) {
  for (const JobTotals& sum : {TotalsOfShards(mesh, grid, options, 3), TotalsOfHalves(mesh, grid, options, whole)}) {
    EXPECT_EQ(sum.voxels, whole.totals.voxels);
    EXPECT_EQ(sum.digest, whole.totals.digest);
    EXPECT_EQ(sum.fields, whole.totals.fields);
  }
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_FIELDS_SHARDS_H_
