// Shared by the exact tiers: lattices whose world coordinates are exact in floats, and conversions to the oracle's
// types.
#ifndef LATVOX_TESTS_UNIT_CORE_EXACT_H_
#define LATVOX_TESTS_UNIT_CORE_EXACT_H_

#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "core/brick/brick.h"
#include "core/lattice/lattice.h"
#include "core/mesh/mesh.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/oracle/meshes.h"
#include "tests/oracle/oracle.h"
#include "tests/unit/core/simd.h"
#include "tests/unit/dose.h"

namespace latvox {

struct ExactLattice {
  std::string name;
  Lattice lattice;
};

// Integer bases whose determinant is a power of two. Lattice coordinates in 1/256 voxel are converted to world
// coordinates in floats, and back, without rounding.
inline std::vector<ExactLattice> ExactLattices() {
  const auto make = [](const char* name, const Mat3d& basis) {
    return ExactLattice{name, Lattice::FromBasis(basis).value()};
  };
  std::vector<ExactLattice> lattices = {make("cartesian", {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}),
                                        make("bcc", {{{2, 0, 0}, {0, 2, 0}, {1, 1, 1}}}),
                                        make("triclinic", {{{4, 1, 1}, {0, 4, 1}, {0, 0, 4}}})};
  if (kSlowed) return lattices;
  lattices.push_back(make("fcc", {{{1, 1, 0}, {1, 0, 1}, {0, 1, 1}}}));
  lattices.push_back(make("mirrored", {{{0, 2, 0}, {1, 0, 0}, {0, 0, 4}}}));
  return lattices;
}

// The hexagonal lattice as well, between whose coordinates and the world's floats lose much less than 1/512 voxel. So
// snapping gives the same coordinates.
inline std::vector<ExactLattice> RestoredLattices() {
  std::vector<ExactLattice> lattices = ExactLattices();
  if (!kSlowed) lattices.push_back({"hexagonal", Lattice::Named(NamedLattice::kHexagonal)});
  return lattices;
}

inline oracle::Int3 ToOracle(const Vec3i& v) { return {v[0], v[1], v[2]}; }

inline std::vector<oracle::Int3> Directions(const std::vector<Frame>& frames) {
  std::vector<oracle::Int3> directions;
  for (const Frame& frame : frames) directions.push_back(ToOracle(frame.q));
  return directions;
}

// The mesh in world coordinates, moved by `shift` voxels.
inline TriangleMesh ToWorld(const oracle::Mesh& mesh, const Lattice& lattice, const Vec3i& shift = {}) {
  TriangleMesh out;
  for (const oracle::Triangle& triangle : mesh) {
    const auto n = static_cast<uint32_t>(out.vertices.size());
    out.triangles.push_back({n, n + 1, n + 2});
    for (const oracle::Int3& v : triangle) {
      Vec3d ijk;
      for (size_t m = 0; m < 3; ++m) ijk[m] = static_cast<double>(v[m]) / 256 + shift[m];
      const Vec3d world = Apply(lattice.basis(), ijk);
      out.vertices.push_back(
          {static_cast<float>(world[0]), static_cast<float>(world[1]), static_cast<float>(world[2])});
    }
  }
  return out;
}

// Adds the voxels of a brick, moved back by `shift`.
inline void AddVoxels(const Brick& brick, const Vec3i& shift, std::set<oracle::Int3>& voxels) {
  for (int32_t n = 0; n < 512; ++n) {
    if (!(brick.mask[static_cast<size_t>(n >> 6)] >> (n & 63) & 1)) continue;
    voxels.insert(ToOracle(brick.brick_ijk * kBrickSide + Vec3i{n >> 6, n >> 3 & 7, n & 7} - shift));
  }
}

inline Grid Unscaled(const Lattice& lattice) { return {lattice, {0, 0, 0}}; }

struct Result {
  std::vector<TileBricks> tiles;
  JobTotals totals;
};

inline Result Voxelize(const TriangleMesh& mesh, const Grid& grid, const VoxelizeOptions& options, int threads = 2) {
  Result result;
  oneapi::tbb::task_arena arena(threads);
  arena.execute([&] {
    auto job = VoxelizeJob::Create(mesh, grid, options);
    ASSERT_TRUE(job.ok()) << job.status();
    const auto done = (*job)->Advance([&](TileBricks&& tile) {
      result.tiles.push_back(std::move(tile));
      return true;
    });
    ASSERT_TRUE(done.ok() && *done) << done.status();
    result.totals = (*job)->totals();
  });
  return result;
}

inline std::set<oracle::Int3> VoxelsOf(const Result& result, const Vec3i& shift = {}) {
  std::set<oracle::Int3> voxels;
  for (const TileBricks& tile : result.tiles) {
    for (const Brick& brick : tile.bricks) AddVoxels(brick, shift, voxels);
  }
  return voxels;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_EXACT_H_
