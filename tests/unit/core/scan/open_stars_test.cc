// Stars that are left out, compared with the rule.
#include "core/scan/open_stars.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/simd.h"
#include "core/base/stop_signal.h"
#include "core/digitize/star.h"
#include "core/scan/candidates.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/triangles.h"

namespace latvox {
namespace {

using Pair = std::pair<uint32_t, uint32_t>;  // voxel, triangle

// The candidates of triangles in one tile.
struct OneTile {
  std::vector<ScanFrame> frames;
  SnappedMesh mesh;
  IndexBox box;
  BitsLayout layout;
  Candidates candidates;

  OneTile(const std::vector<ScanFrame>& of, const Vec3i& tile_min, const std::vector<Triangle>& triangles)
      : frames(of),
        mesh(MeshOf(triangles)),
        box{tile_min - ReachOf(of), tile_min + Vec3i{kTileSide, kTileSide, kTileSide} + ReachOf(of)},
        layout(tile_min, ReachOf(of) * 2) {
    FindCandidates(mesh, Iota(triangles.size()), frames, {box, layout, StopSignal(), SIZE_MAX}, candidates);
  }

  std::set<Pair> AllPairs() const {
    std::set<Pair> pairs;
    uint32_t crossed = 0, rim = 0;
    const auto add = [&](const Candidates::Run& run, uint32_t voxel) {
      pairs.insert({voxel & kNumberMask, candidates.TriangleAt(run, voxel >> kNumberBits)});
    };
    for (const Candidates::Run& run : candidates.runs) {
      for (; crossed < run.crossed_end; ++crossed) add(run, candidates.nearer[crossed]);
      for (; rim < run.rim_end; ++rim) add(run, candidates.rim[rim]);
    }
    return pairs;
  }

  std::set<Pair> OpenPairs(const TileBits& set) const {
    const NeighborRows rows(frames, layout);
    std::vector<VoxelTriangle> pairs;
    for (size_t run = 0; run < candidates.runs.size(); ++run) {
      AppendOpenStars(mesh, frames, layout, rows, set, candidates, run, pairs);
    }
    std::set<Pair> open;
    for (const auto& [voxel, triangle] : pairs) EXPECT_TRUE(open.insert({voxel, triangle}).second);
    return open;
  }
};

// The ends of all links of a star.
std::vector<uint32_t> EndsOf(const OneTile& tile, const std::vector<Triangle>& triangles, const Pair& pair) {
  const OrientedTriangle oriented(triangles[pair.second]);
  const Vec3i z = tile.layout.VoxelAt(pair.first);
  const Star star(oriented, z);
  std::vector<uint32_t> ends;
  for (const ScanFrame& scan : tile.frames) {
    Vec3i step{};
    if (star.IsNearerEnd(scan.frame.q, step)) ends.push_back(tile.layout.NumberOf(z + step));
  }
  if (!ends.empty()) ends.push_back(pair.first);
  return ends;
}

// All ends are in the set, except a few.
TEST(OpenStars, AreAllThatHaveALinkToAVoxelOutsideOfTheSetOnEachKernel) {
  const Vec3i tile_min{128, 64, 192};
  for (const ExactLattice& l : ExactLattices()) {
    for (int k : {0, 2}) {
      const auto frames = MakeScanFrames(l.lattice.frames(k));
      for (const auto& [size, count] : {std::pair<int32_t, size_t>{60, 600},
                                        {400, 300},
                                        {2200, 100},
                                        {9000, 20},
                                        {40000, 6},
                                        {1 << 22, 4},
                                        {1 << 23, 4}}) {
        auto triangles = TrianglesAround(tile_min, size, count);
        if (size == 40000) triangles = LargeAndClose(tile_min);
        for (const Simd simd : SimdHere()) {
          const ForcedSimd forced(simd);
          SCOPED_TRACE(testing::Message() << l.name << " k " << k << " size " << size << " " << SimdInUse());
          const OneTile tile(frames, tile_min, triangles);
          std::mt19937 random(kSeed);
          std::set<uint32_t> ends;
          const std::set<Pair> pairs = tile.AllPairs();
          for (const Pair& pair : pairs) {
            for (const uint32_t end : EndsOf(tile, triangles, pair)) ends.insert(end);
          }
          TileBits set(tile.layout.Words());
          for (const uint32_t end : ends) {
            if (random() % 64 != 0) set.Set(end);
          }
          const std::set<Pair> open = tile.OpenPairs(set);
          for (const Pair& pair : pairs) {
            if (open.contains(pair)) continue;
            for (const uint32_t end : EndsOf(tile, triangles, pair)) ASSERT_TRUE(set.Test(end));
          }
          for (const Pair& pair : open) EXPECT_TRUE(pairs.contains(pair));
        }
      }
    }
  }
}

// One triangle that slants, and others that lie on lattice points.
TEST(OpenStars, AreFewOnceTheLinksAlongPrincipalDirectionsHaveBeenAddedOnEachKernel) {
  const std::vector<std::vector<Triangle>> planes{
      {{{{300, 900, 400}, {15800, 2100, 5100}, {2500, 15300, 9700}}}},
      {{{{0, 0, 5120}, {15000, 0, 5120}, {0, 15000, 5120}}}},
      {{{{5120, 0, 0}, {5120, 15000, 0}, {5120, 0, 15000}}}},
      {{{{5000, 5120, 0}, {5120, 5000, 15000}, {-4880, 15000, 0}}}},  // several directions have the largest |n . q|
      {{{{15000, 100, 0}, {100, 15000, 0}, {0, 100, 15000}}}},
  };
  for (const ExactLattice& l : ExactLattices()) {
    const auto frames = MakeScanFrames(l.lattice.frames(0));
    for (const auto& triangles : planes) {
      for (const Simd simd : SimdHere()) {
        const ForcedSimd forced(simd);
        if (SimdIsScalar()) continue;  // it leaves out none
        const OneTile tile(frames, {0, 0, 0}, triangles);
        TileBits set(tile.layout.Words());
        set.SetAll(tile.candidates.nearer.view());
        set.SetAll(tile.candidates.farther.view());
        const size_t pairs = tile.AllPairs().size();
        EXPECT_GT(pairs, 900U);
        EXPECT_LT(tile.OpenPairs(set).size(), pairs / 3) << l.name << " " << SimdInUse();
      }
    }
  }
}

// Its directions reach farther across rows than along them: (5, 1, 2) and others with entries of at most 4 along rows.
TEST(OpenStars, OfDirectionsAcrossRowsReadNothingOutsideOfTheSetOnEachKernel) {
  const Lattice lattice = Lattice::FromBasis({{{6, -7, -10}, {-41, 79, 70}, {9, -17, -10}}}).value();
  const auto frames = MakeScanFrames(lattice.frames(0));
  const Vec3i reach = ReachOf(frames);
  ASSERT_GT(std::max(reach[0], reach[1]), reach[2]);
  const Vec3i tile_min{0, 0, 0}, lowest = (tile_min - reach) * kLatticeUnit;
  std::vector<Triangle> triangles;
  for (int32_t n = 0; n < 40; ++n) {
    triangles.push_back({lowest + Vec3i{-900, -900, 90 - 7 * n}, lowest + Vec3i{900, -900, 8 * n - 80},
                         lowest + Vec3i{-30 * n, 900, 50 - n}});
  }
  for (const Simd simd : SimdHere()) {
    const ForcedSimd forced(simd);
    const OneTile tile(frames, tile_min, triangles);
    const std::set<Pair> pairs = tile.AllPairs();
    const uint32_t corner = tile.layout.NumberOf(tile.box.min);
    EXPECT_TRUE(std::ranges::any_of(pairs, [corner](const Pair& pair) { return pair.first == corner; }));
    EXPECT_EQ(tile.OpenPairs(TileBits(tile.layout.Words())), pairs) << SimdInUse();  // nothing is in the set
  }
}

}  // namespace
}  // namespace latvox
