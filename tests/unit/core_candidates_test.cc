// Candidates of one triangle or many, held against the crossing rule in every direction; and the scans that find them.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>
#include <span>

#include "core/digitize/candidates.h"
#include "core/digitize/crossing.h"
#include "core/digitize/line_scan.h"
#include "core/digitize/star.h"
#include "core/digitize/stars.h"
#include "tests/unit/core_exact.h"
#include "tests/unit/core_triangles.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

const std::atomic<bool> kNotCancelled = false;

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

// Adds the same from candidates, and from their stars; checks the crossed edges on the way.
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
  std::vector<StarEdges> stars(pairs.size());
  FindStarEdges(mesh, frames, layout, pairs, stars.data());
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
    const size_t taken = FindCandidates(mesh, left, frames, box, layout, kNotCancelled, enough, candidates);
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

// Small triangles and large ones in turns: so many that they are sorted, window by window.
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

// Large, and nearly all of their lattice lines are hard to round: planes that are parallel to axes or all but that,
// next to where depths are ties; and slivers of an area of 3/2 lattice units, with a lattice point on their longest
// edge.
std::vector<Triangle> LargeAndClose(const Vec3i& tile_min) {
  std::mt19937 random(kSeed);
  const auto among = [&](int32_t least, int32_t most) {
    return std::uniform_int_distribution<int32_t>(least, most)(random);
  };
  std::vector<Triangle> triangles;
  const auto add = [&](Triangle triangle) {
    const Vec3i at = (tile_min + Vec3i{among(0, 63), among(0, 63), among(0, 63)}) * kLatticeUnit;
    const auto first = static_cast<size_t>(among(0, 2));  // which axis x is
    for (Vec3i& v : triangle) v = at + Vec3i{v[first], v[(first + 1) % 3], v[(first + 2) % 3]};
    if (among(0, 1) == 0) std::swap(triangle[0], triangle[1]);
    triangles.push_back(triangle);
  };
  for (const int32_t size : {1 << 15, 1 << 21}) {
    for (const int32_t most : {0, 1, 40}) {
      for (int n = 0; n < Dose(8, 2); ++n) {
        const int32_t z = among(0, 1) * kLatticeUnit / 2;
        add({{{-among(1, size), -among(1, size), z + among(-most, most)},
              {among(1, size), -among(1, size), z + among(-most, most)},
              {among(-size, size), among(1, size), z + among(-most, most)}}});
      }
    }
  }
  for (int n = 0; n < Dose(20, 5); ++n) {
    constexpr int32_t kFar = kMaxExtent * kLatticeUnit / 2 - 1, kNear = 1 << 13;
    add({{{-among(0, kNear), -among(0, kNear), among(-kNear, kNear)},
          {among(kFar / 2, kFar), among(-kFar, kFar), among(-kFar, kFar)},
          {among(-kFar, kFar), among(kFar / 2, kFar), among(-kFar, kFar)}}});
  }
  for (int n = 0; n < Dose(40, 10); ++n) {
    // Corners at -u, 2u and w - u, with det(u, w) = 1; in z, planes of slope -1, 0 or 1.
    Vec<int64_t, 2> u{among(1 << 13, 1 << 15), among(1 << 13, 1 << 15)}, w{};
    while (std::gcd(u[0], u[1]) != 1) ++u[1];
    while ((u[0] * w[1] - 1) % u[1] != 0) ++w[1];
    w[0] = (u[0] * w[1] - 1) / u[1];
    const int32_t over_x = among(-1, 1), over_y = among(-1, 1), z = among(0, kLatticeUnit);
    const auto corner = [&](const Vec<int64_t, 2>& p) {
      const auto x = static_cast<int32_t>(p[0]), y = static_cast<int32_t>(p[1]);
      return Vec3i{x, y, z + over_x * x + over_y * y};
    };
    add({corner(-u), corner(u + u), corner(w - u)});
  }
  return triangles;
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

// So that some lines have their voxels in the box and others beyond.
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

// Where edges of triangles are longer, an edge function exceeds 32 bits in the last of the box's rows.
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

// What is known of one line.
struct LineFacts {
  bool candidate, inside, in_doubt;
  int64_t depth;
  bool above;
};

template <class T>
LineFacts FactsOf(const LineScan<T>& lines, int32_t a, int32_t b) {
  LineFacts facts{true, true, false, 0, false};
  for (size_t n = 0; n < 3; ++n) {
    const auto edge =
        static_cast<T>(int64_t{lines.edge[n]} + int64_t{lines.edge_a[n]} * a + int64_t{lines.edge_b[n]} * b);
    facts.candidate &= static_cast<T>(int64_t{edge} + lines.rim[n]) >= 0;  // as lanes add
    facts.inside &= edge >= 0;
  }
  const auto level = crossing_internal::FloorDivision(
      __int128{lines.remainder} + __int128{lines.level_a} * a + __int128{lines.level_b} * b, lines.along);
  facts.depth = lines.depth + level.quotient;
  facts.above = level.remainder >= lines.half;
  for (const int64_t tie : {int64_t{0}, int64_t{lines.half}, int64_t{lines.along}}) {
    facts.in_doubt |= std::abs(level.remainder - tie) <= lines.doubt && lines.doubt != 0;
  }
  return facts;
}

TEST(LineScan, IsTheSameInFewerBitsWhereItIsNotInDoubt) {
  const Vec3i tile_min{0, 0, 0};
  for (const ExactLattice& l : ExactLattices()) {
    const auto frames = MakeScanFrames(l.lattice.frames(0));
    const IndexBox box{tile_min, tile_min + Vec3i{kTileSide, kTileSide, kTileSide} * 2};
    std::vector<Triangle> triangles = LargeAndClose(tile_min);
    const size_t close = triangles.size();
    for (const int32_t size : {20000, 1 << 19, 1 << 23}) {
      const auto some = TrianglesAround(tile_min, size, 60);
      triangles.insert(triangles.end(), some.begin(), some.end());
    }
    size_t rounded_lines = 0, in_doubt = 0, exact = 0;
    for (size_t t = 0; t < triangles.size(); ++t) {
      const OrientedTriangle triangle(triangles[t]);
      if (triangle.normal == Vec<int64_t, 3>{}) continue;
      const ScanFrame& scan = PrincipalScanFrame(frames, triangle.normal);
      LineScan<int64_t> lines;
      if (!MakeLineScan(triangle, scan, box, NearBox(frames, box), lines)) continue;
      for (const bool rounded : {true, false}) {
        LineScan<int32_t> narrow;
        if (!Narrow(lines, rounded, narrow)) continue;
        EXPECT_EQ(narrow.doubt != 0, rounded);
        if (!rounded) ++exact;
        for (int32_t b = 0; b < lines.height; ++b) {
          for (int32_t a = 0; a < lines.width; ++a) {
            const LineFacts want = FactsOf(lines, a, b), got = FactsOf(narrow, a, b);
            ASSERT_EQ(got.candidate, want.candidate) << l.name << " triangle " << t << " line " << a << " " << b;
            if (!want.candidate) continue;
            ASSERT_EQ(got.inside, want.inside) << l.name << " triangle " << t << " line " << a << " " << b;
            if (rounded) {  // how far remainders are wrong, not only whether that matters here
              const auto truth = __int128{lines.remainder} + __int128{lines.level_a} * a + __int128{lines.level_b} * b;
              const auto scaled =
                  __int128{narrow.remainder} + __int128{narrow.level_a} * a + __int128{narrow.level_b} * b;
              const __int128 wrong = scaled * lines.along - (truth << kScaledBits);
              ASSERT_LT(static_cast<double>(wrong < 0 ? -wrong : wrong) / static_cast<double>(lines.along),
                        narrow.doubt)
                  << l.name << " triangle " << t << " line " << a << " " << b;
            }
            if (rounded && t >= close) {
              ++rounded_lines;
              in_doubt += got.in_doubt ? 1 : 0;
            }
            if (got.in_doubt) continue;
            ASSERT_EQ(got.depth, want.depth) << l.name << " triangle " << t << " line " << a << " " << b;
            ASSERT_EQ(got.above, want.above) << l.name << " triangle " << t << " line " << a << " " << b;
          }
        }
      }
    }
    EXPECT_GT(exact, 10U) << l.name;
    EXPECT_GT(rounded_lines, 10000U) << l.name;
    EXPECT_LT(in_doubt, rounded_lines / 1000) << l.name;
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
