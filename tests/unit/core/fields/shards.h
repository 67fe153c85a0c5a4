// All parts of a job together.
#ifndef LATVOX_TESTS_UNIT_CORE_FIELDS_SHARDS_H_
#define LATVOX_TESTS_UNIT_CORE_FIELDS_SHARDS_H_

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

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_FIELDS_SHARDS_H_
