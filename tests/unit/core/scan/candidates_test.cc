// Candidates of one triangle or many, compared with the crossing rule in every direction.
#include "core/scan/candidates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <span>

#include "core/base/simd.h"
#include "core/base/stop_signal.h"
#include "core/digitize/crossing.h"
#include "core/digitize/star.h"
#include "core/scan/line_scan.h"
#include "core/scan/stars.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/triangles.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

using Found = std::set<std::pair<uint32_t, Vec3i>>;  // triangle, voxel

// All nearer ends in the box, from the plain scan of every direction.
Found Expected(const std::vector<Triangle>& triangles, const std::vector<ScanFrame>& frames, const IndexBox& box) {
  Found found;
  for (uint32_t n = 0; n < triangles.size(); ++n) {
    for (const ScanFrame& scan : frames) {
      ForEachCrossing(triangles[n], scan.frame, box, [&](const Vec3i& nearer, const Vec3i&) {
        found.insert({n, nearer});
      });
    }
  }
  return found;
}

// Adds the same from candidates and their stars. Also checks the crossed links.
void AddFound(const Candidates& candidates, const SnappedMesh& mesh, const std::vector<Triangle>& triangles,
              const std::vector<ScanFrame>& frames, const IndexBox& box, const BitsLayout& layout, Found& found) {
  std::vector<VoxelTriangle> pairs;
  size_t crossed = 0, rim = 0;
  for (const Candidates::Run& run : candidates.runs) {
    for (; crossed < run.crossed_end; ++crossed) {
      const uint32_t t = candidates.TriangleAt(run, candidates.nearer[crossed] >> kNumberBits);
      const Vec3i nearer = layout.VoxelAt(candidates.nearer[crossed] & kNumberMask);
      const Vec3i farther = layout.VoxelAt(candidates.farther[crossed] & kNumberMask);
      EXPECT_TRUE(box.Contains(nearer));
      const OrientedTriangle oriented(triangles[t]);
      const Vec3i& q = PrincipalScanFrame(frames, oriented.normal).frame.q;
      EXPECT_TRUE(farther == nearer + q || farther == nearer - q);
      Vec3i step{};
      EXPECT_TRUE(Star(oriented, nearer).IsNearerEnd(q, step));
      EXPECT_EQ(nearer + step, farther);
      found.insert({t, nearer});
    }
    for (; rim < run.rim_end; ++rim) {
      const uint32_t t = candidates.TriangleAt(run, candidates.rim[rim] >> kNumberBits);
      pairs.push_back({candidates.rim[rim] & kNumberMask, t});
      EXPECT_TRUE(box.Contains(layout.VoxelAt(pairs.back().voxel)));
    }
  }
  EXPECT_EQ(crossed, candidates.nearer.size());
  EXPECT_EQ(rim, candidates.rim.size());
  std::vector<StarLinks> stars(pairs.size());
  FindStarLinks(mesh, frames, layout, pairs, stars.data());
  for (size_t n = 0; n < pairs.size(); ++n) {
    if (stars[n].nearer != 0) found.insert({pairs[n].triangle, layout.VoxelAt(pairs[n].voxel)});
  }
}

// In parts of about `enough` candidates, in a cube of tiles, `side` voxels a side.
Found FromCandidates(const std::vector<Triangle>& triangles, const std::vector<ScanFrame>& frames, const IndexBox& box,
                     const Vec3i& tile_min, size_t enough = SIZE_MAX, int32_t side = kTileSide) {
  const SnappedMesh mesh = MeshOf(triangles);
  const BitsLayout layout(tile_min, tile_min - box.min + ReachOf(frames), side);
  const std::vector<uint32_t> numbers = Iota(triangles.size());
  Found found;
  for (std::span<const uint32_t> left = numbers; !left.empty();) {
    Candidates candidates;
    const size_t taken = FindCandidates(mesh, left, frames, {box, layout, StopSignal(), enough}, candidates);
    EXPECT_GT(taken, 0U);
    EXPECT_TRUE(candidates.size() >= enough || taken == left.size());
    if (taken == 0) break;
    AddFound(candidates, mesh, triangles, frames, box, layout, found);
    left = left.subspan(taken);
  }
  return found;
}

// Sizes on both sides of every limit: lines together or in blocks, 32 or 64 bits, and beyond the tile.
TEST(Candidates, AndStarsFindTheVoxelsOfEveryDirectionOnEachKernel) {
  const Vec3i tile_min{128, 64, 192};
  for (const ExactLattice& l : ExactLattices()) {
    for (int k : {0, 2}) {
      const auto frames = MakeScanFrames(l.lattice.frames(k));
      const Vec3i reach = ReachOf(frames);
      const IndexBox box{tile_min - reach * 2, tile_min + Vec3i{kTileSide, kTileSide, kTileSide} + reach * 2};
      for (const auto& [size, count] : {std::pair<int32_t, size_t>{60, 1000},
                                        {400, 500},
                                        {1500, 200},
                                        {2200, 200},
                                        {9000, 40},
                                        {14000, 40},
                                        {40000, 10},
                                        {1 << 22, 5},
                                        {1 << 23, 5}}) {
        const auto triangles = TrianglesAround(tile_min, size, count);
        const Found expected = Expected(triangles, frames, box);
        EXPECT_GT(expected.size(), 0U);
        for (const Simd simd : SimdHere()) {
          const ForcedSimd forced(simd);
          ASSERT_EQ(FromCandidates(triangles, frames, box, tile_min), expected)
              << l.name << " k " << k << " size " << size << " " << SimdInUse() << " seed " << kSeed;
        }
      }
    }
  }
}

// Small and large triangles in turn, so many that they are sorted window by window.
TEST(Candidates, OfTrianglesOfAllSizesAreFoundInPartsOnEachKernel) {
  const Vec3i tile_min{128, 64, 192};
  for (const ExactLattice& l : ExactLattices()) {
    const auto frames = MakeScanFrames(l.lattice.frames(0));
    const Vec3i reach = ReachOf(frames);
    const IndexBox box{tile_min - reach * 2, tile_min + Vec3i{kTileSide, kTileSide, kTileSide} + reach * 2};
    std::vector<Triangle> triangles;
    for (const auto& [size, count] : {std::pair<int32_t, size_t>{300, 100}, {1200, 600}, {5000, 40}, {40000, 4}}) {
      const auto some = TrianglesAround(tile_min, size, count);
      triangles.insert(triangles.end(), some.begin(), some.end());
    }
    std::shuffle(triangles.begin(), triangles.end(), std::mt19937(kSeed));
    const Found expected = Expected(triangles, frames, box);
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      for (const size_t enough : {size_t{1}, size_t{3000}, SIZE_MAX}) {
        ASSERT_EQ(FromCandidates(triangles, frames, box, tile_min, enough), expected)
            << l.name << " " << SimdInUse() << " enough " << enough << " seed " << kSeed;
      }
    }
  }
}

// A voxel is at most half a step from the point where its link meets the triangle. The box is the largest that bytes
// hold.
TEST(Candidates, HaveBoxesByWhichTheLargeTrianglesOfVoxelsAreFoundOnEachKernel) {
  const Vec3i tile_min{128, 64, 192};
  for (const ExactLattice& l : ExactLattices()) {
    const auto frames = MakeScanFrames(l.lattice.frames(0));
    const Vec3i reach = ReachOf(frames);
    const IndexBox box{tile_min, tile_min + Vec3i{1, 1, 1} * TriangleBoxes::kMostSide};
    const BitsLayout layout(tile_min, reach, TriangleBoxes::kMostSide);
    std::vector<Triangle> triangles = TrianglesAround(tile_min, 9000, Dose(150, 50));
    for (const Triangle& t : TrianglesAround(tile_min + Vec3i{190, 190, 190}, 9000, Dose(30, 10)))
      triangles.push_back(t);
    for (const Triangle& t : TrianglesAround(tile_min, 1 << 18, 5)) triangles.push_back(t);
    const Found contributed = Expected(triangles, frames, box);
    std::set<uint32_t> voxels;
    for (const auto& [t, voxel] : contributed) {
      if ((voxel[0] + voxel[1] + voxel[2]) % 5 == 0) voxels.insert(layout.NumberOf(voxel));
    }
    Found expected;
    for (const uint32_t voxel : voxels) {
      const Vec3i z = layout.VoxelAt(voxel);
      for (uint32_t t = 0; t < triangles.size(); ++t) {
        bool inside = true;
        for (size_t m = 0; m < 3; ++m) {
          const auto [low, high] = std::minmax({triangles[t][0][m], triangles[t][1][m], triangles[t][2][m]});
          const int32_t half = reach[m] * (kLatticeUnit / 2), at = z[m] * kLatticeUnit;
          inside &= low - half <= at && at <= high + half;
        }
        if (inside) expected.insert({t, z});
      }
    }
    for (const auto& [t, voxel] : contributed) {
      if (voxels.contains(layout.NumberOf(voxel))) {
        EXPECT_TRUE(expected.contains({t, voxel}));
      }
    }
    const SnappedMesh mesh = MeshOf(triangles);
    const std::vector<uint32_t> asked(voxels.begin(), voxels.end());
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      if (SimdIsScalar()) continue;  // it has no boxes
      Candidates candidates;
      FindCandidates(mesh, Iota(triangles.size()), frames, {box, layout, StopSignal(), SIZE_MAX}, candidates);
      ASSERT_EQ(candidates.boxes.size(), triangles.size());
      const auto find = [&](size_t most, std::vector<VoxelTriangle>& pairs) {
        return candidates.boxes.FindPairs(layout, box.min, candidates.triangles, asked, most, pairs);
      };
      std::vector<VoxelTriangle> pairs;
      EXPECT_FALSE(find(expected.size() - 1, pairs));
      EXPECT_TRUE(find(expected.size(), pairs));
      Found found;
      for (const auto& [voxel, t] : pairs) EXPECT_TRUE(found.insert({t, layout.VoxelAt(voxel)}).second);
      ASSERT_EQ(found, expected) << l.name << " " << SimdInUse() << " seed " << kSeed;
    }
  }
}

// There are no boxes where triangles have few candidates, or where bytes do not hold the coordinates.
TEST(Candidates, HaveNoBoxesWhereThesePayNotOrDoNotFitOnEachKernel) {
  const auto frames = MakeScanFrames(Lattice::Named(NamedLattice::kCartesian).frames(0));
  const auto boxes = [&](const std::vector<Triangle>& triangles, int32_t side) {
    Candidates candidates;
    const SearchLimits limits{
        {{0, 0, 0}, {side, side, side}}, BitsLayout({0, 0, 0}, {1, 1, 1}, side), StopSignal(), SIZE_MAX};
    FindCandidates(MeshOf(triangles), Iota(triangles.size()), frames, limits, candidates);
    return candidates.boxes.size();
  };
  const auto large = TrianglesAround({0, 0, 0}, 9000, 100), small = TrianglesAround({0, 0, 0}, 100, 100);
  for (const Simd simd : SimdHere()) {
    const ForcedSimd forced(simd);
    if (SimdIsScalar()) continue;
    EXPECT_EQ(boxes(large, TriangleBoxes::kMostSide), large.size()) << SimdInUse();
    EXPECT_EQ(boxes(large, TriangleBoxes::kMostSide + 8), 0U) << SimdInUse();
    EXPECT_LT(boxes(small, kTileSide), small.size()) << SimdInUse();
  }
}

// Depths just below an integer, where an estimate in floats is the integer itself.
TEST(Candidates, RoundDepthsDownOnEachKernel) {
  struct Case {
    Lattice lattice;
    int k;
    Triangle triangle;
  };
  for (const Case& c :
       {Case{Lattice::Named(NamedLattice::kBcc), 0, {{{13006, 6057, 664}, {5583, -165, 948}, {5583, 352, 6369}}}},
        Case{Lattice::Named(NamedLattice::kHexagonal),
             2,
             {{{11177, -4968, 13518}, {4955, -4684, 6095}, {5472, 737, 6095}}}}}) {
    const auto frames = MakeScanFrames(c.lattice.frames(c.k));
    const Vec3i tile_min{0, 0, 0};
    const IndexBox box{tile_min, tile_min + Vec3i{kTileSide, kTileSide, kTileSide}};
    const Found expected = Expected({c.triangle}, frames, box);
    EXPECT_GT(expected.size(), 0U);
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      EXPECT_EQ(FromCandidates({c.triangle}, frames, box, tile_min), expected) << SimdInUse();
    }
  }
}

TEST(Candidates, OfLargeTrianglesWithDepthsThatAreHardToRoundOnEachKernel) {
  const Vec3i tile_min{64, 0, 128};
  constexpr int32_t kSide = 2 * kTileSide;
  for (const ExactLattice& l : ExactLattices()) {
    const auto frames = MakeScanFrames(l.lattice.frames(0));
    const Vec3i reach = ReachOf(frames);
    const IndexBox box{tile_min - reach * 2, tile_min + Vec3i{kSide, kSide, kSide} + reach * 2};
    const auto triangles = LargeAndClose(tile_min);
    const Found expected = Expected(triangles, frames, box);
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      ASSERT_EQ(FromCandidates(triangles, frames, box, tile_min, SIZE_MAX, kSide), expected)
          << l.name << " " << SimdInUse();
    }
  }
}

// Some lines have their voxels in the box, others beyond.
TEST(Candidates, OfTrianglesAlongTheSidesOfTheBoxOnEachKernel) {
  const Vec3i tile_min{64, 0, 128};
  for (const ExactLattice& l : ExactLattices()) {
    const auto frames = MakeScanFrames(l.lattice.frames(0));
    const Vec3i reach = ReachOf(frames);
    const IndexBox box{tile_min - reach, tile_min + Vec3i{kTileSide, kTileSide, kTileSide} + reach};
    std::mt19937 random(kSeed);
    std::uniform_int_distribution<int32_t> beside(-300, 300);
    std::vector<Triangle> triangles;
    for (const int32_t size : {20, 60, 200}) {
      for (int n = 0; n < Dose(120, 30); ++n) {
        const size_t axis = n % 3;
        const int32_t side = n % 2 == 0 ? box.min[axis] : box.max[axis] - 1;
        Triangle& triangle = triangles.emplace_back();
        for (Vec3i& v : triangle) {
          for (size_t m = 0; m < 3; ++m) {
            std::uniform_int_distribution<int32_t> within(0, size * kLatticeUnit);
            v[m] = m == axis ? side * kLatticeUnit + beside(random) : box.min[m] * kLatticeUnit + within(random);
          }
        }
      }
    }
    const Found expected = Expected(triangles, frames, box);
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      ASSERT_EQ(FromCandidates(triangles, frames, box, tile_min), expected) << l.name << " " << SimdInUse();
    }
  }
}

// With longer edges of triangles, an edge function would exceed 32 bits in the box's last row.
TEST(Candidates, OfEdgesAboutAsLongAs32BitsHoldAreThoseOfThePlainScanOnEachKernel) {
  constexpr int32_t kSide = 2 * kTileSide, kLow = 1 << 15;
  const Vec3i tile_min{kLow, kLow, kLow}, low = tile_min * kLatticeUnit;
  const auto frames = MakeScanFrames(Lattice::Named(NamedLattice::kCartesian).frames(2));
  const IndexBox box{tile_min, tile_min + Vec3i{kSide, kSide, kSide}};
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<int32_t> beside(0, 255), depth(0, kSide * kLatticeUnit);
  std::uniform_int_distribution<int32_t> length(INT32_MAX / 128 - 100'000, INT32_MAX / 126);
  std::vector<Triangle> triangles;
  for (int n = 0; n < Dose(100, 40); ++n) {
    const Vec3i first = low + Vec3i{-8'000'000, beside(random), depth(random)};
    const int32_t z = depth(random) - depth(random);
    triangles.push_back({first, first + Vec3i{length(random), 0, 0}, first + Vec3i{8'000'000, 20'000'000, z}});
  }
  const Found expected = Expected(triangles, frames, box);
  EXPECT_GT(expected.size(), 100'000U);
  for (const Simd simd : SimdHere()) {
    const ForcedSimd forced(simd);
    EXPECT_EQ(FromCandidates(triangles, frames, box, tile_min, SIZE_MAX, kSide), expected) << SimdInUse();
  }
}

// Near a lattice point on an edge, the edge function is as close to 0 as it can be without being 0.
TEST(Candidates, OfEdgesThroughLatticePointsOnEachKernel) {
  const Vec3i tile_min{0, 0, 0};
  for (const ExactLattice& l : ExactLattices()) {
    const auto frames = MakeScanFrames(l.lattice.frames(0));
    const Vec3i reach = ReachOf(frames);
    const IndexBox box{tile_min - reach, tile_min + Vec3i{kTileSide, kTileSide, kTileSide} + reach};
    std::mt19937 random(kSeed);
    std::vector<Triangle> triangles;
    for (const int32_t size : {1200, 3000, 6500}) {
      std::uniform_int_distribution<int32_t> offset(-size, size), voxel(28, 36);
      const auto any = [&](auto& of) { return Vec3i{of(random), of(random), of(random)}; };
      for (int n = 0; n < Dose(200, 60); ++n) {
        const Vec3i point = any(voxel) * kLatticeUnit, to = any(offset);
        triangles.push_back({point + to, point - to, point + any(offset)});
      }
    }
    const Found expected = Expected(triangles, frames, box);
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      ASSERT_EQ(FromCandidates(triangles, frames, box, tile_min), expected) << l.name << " " << SimdInUse();
    }
  }
}

// Triangles between the corners of a cube have the largest normals.
TEST(Candidates, OfTheLargestTrianglesThatFit32BitsAreThoseOfThePlainScanOnEachKernel) {
  for (const ExactLattice& l : ExactLattices()) {
    const auto frames = MakeScanFrames(l.lattice.frames(0));
    const int32_t extent = NarrowExtent(frames);
    EXPECT_GE(extent, 1 << 13) << l.name;
    const Vec3i reach = ReachOf(frames), tile_min{0, 0, 0};
    const IndexBox box{tile_min - reach, tile_min + Vec3i{kTileSide, kTileSide, kTileSide} + reach};
    for (const int32_t side : {extent, extent + 1}) {
      std::vector<Triangle> triangles;
      const auto corner = [&](int n) { return Vec3i{n >> 2, n >> 1 & 1, n & 1} * side; };
      for (int a = 0; a < 8; ++a) {
        for (int b = a + 1; b < 8; ++b) {
          for (int c = b + 1; c < 8; c += Dose(1, 3)) triangles.push_back({corner(a), corner(b), corner(c)});
        }
      }
      const Found expected = Expected(triangles, frames, box);
      for (const Simd simd : SimdHere()) {
        const ForcedSimd forced(simd);
        ASSERT_EQ(FromCandidates(triangles, frames, box, tile_min), expected) << l.name << " " << SimdInUse();
      }
    }
  }
}

TEST(Candidates, OfAdversarialMeshesAreThoseOfThePlainScanOnEachKernel) {
  for (const ExactLattice& l : ExactLattices()) {
    const auto frames = MakeScanFrames(l.lattice.frames(0));
    const Vec3i reach = ReachOf(frames);
    for (const auto& mesh : oracle::AdversarialMeshes(33, Directions(l.lattice.frames(0)))) {
      std::vector<Triangle> triangles;
      for (const auto& t : mesh.triangles) {
        Triangle& triangle = triangles.emplace_back();
        for (size_t n = 0; n < 3; ++n) {
          for (size_t m = 0; m < 3; ++m) triangle[n][m] = static_cast<int32_t>(t[n][m]);
        }
      }
      for (const Vec3i& tile_min : {Vec3i{0, 0, 0}, Vec3i{-64, 0, -64}}) {
        const IndexBox box{tile_min - reach * 2, tile_min + Vec3i{kTileSide, kTileSide, kTileSide} + reach * 2};
        const Found expected = Expected(triangles, frames, box);
        for (const Simd simd : SimdHere()) {
          const ForcedSimd forced(simd);
          ASSERT_EQ(FromCandidates(triangles, frames, box, tile_min), expected)
              << l.name << " " << mesh.name << " " << SimdInUse();
        }
      }
    }
  }
}

}  // namespace
}  // namespace latvox
