// Each kernel by itself, compared with plain C++. candidates_test.cc tests candidates.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>
#include <string_view>

#include "core/digitize/crossing.h"
#include "core/digitize/star.h"
#include "core/scan/stars.h"
#include "core/tile/cut_out.h"
#include "core/tiny/touching.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/triangles.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

TEST(Simd, IsNamedAfterKernelsThatAreCompiled) {
  const std::set<std::string_view> compiled{"scalar", "avx2", "avx512", "NEON"};
  WithEachSimd([&] { EXPECT_TRUE(compiled.contains(SimdInUse())) << SimdInUse(); });
}

TEST(Touching, LeavesOutOnlyTrianglesWithoutCrossingsAndMostOfThoseOnEachKernel) {
  const Vec3i tile_min{64, 0, 0};
  constexpr int32_t kFar = 1 << 20;
  const IndexBox everywhere{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};
  for (const ExactLattice& l : ExactLattices()) {
    for (int k : {0, 2}) {
      const auto frames = MakeScanFrames(l.lattice.frames(k));
      for (const int32_t size : {8, 40, 300, CornerList::kNear + 100}) {
        auto triangles = TrianglesAround(tile_min, size, size > CornerList::kNear ? 101 : 1001);
        for (size_t n = 0; n < triangles.size(); n += 50) {  // slivers with a corner that does not fit 16 bits
          triangles[n][1] = triangles[n][0] + Vec3i{1 << 16, 1 << 16, 3};
          triangles[n][2] = triangles[n][0] + Vec3i{40, 60, 5};
        }
        const SnappedMesh mesh = MeshOf(triangles);
        std::set<uint32_t> crossed;
        for (uint32_t t = 0; t < triangles.size(); ++t) {
          for (const ScanFrame& scan : frames) {
            ForEachCrossing(triangles[t], scan.frame, everywhere,
                            [&](const Vec3i&, const Vec3i&) { crossed.insert(t); });
          }
        }
        std::vector<uint32_t> scalar;
        for (const Simd simd : SimdHere()) {
          const ForcedSimd forced(simd);
          std::vector<uint32_t> touching;
          ForEachList(mesh, {}, [&](CornerList& list) {
            KeepTouching(LineForms(frames), list);
            touching.insert(touching.end(), list.triangles, list.triangles + list.size);
          });
          ASSERT_TRUE(std::is_sorted(touching.begin(), touching.end())) << SimdInUse();
          ASSERT_TRUE(std::includes(touching.begin(), touching.end(), crossed.begin(), crossed.end()))
              << l.name << " k " << k << " size " << size << " " << SimdInUse();
          if (simd == Simd::kScalar) scalar = touching;
          EXPECT_EQ(touching, scalar) << SimdInUse();
        }
        if (size == 8) {
          EXPECT_LT(scalar.size(), triangles.size() / 2) << l.name << " k " << k;
        }
      }
    }
  }
}

// Corners up to and beyond the range of a list, and lists that end within a vector.
TEST(CornerList, HoldsCornersFromTheFirstOnesVoxelOnEachKernel) {
  constexpr int32_t kFar = (kMaxExtent + kTileSide) * kLatticeUnit - 1;
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<int32_t> anywhere(0, kFar), near(-CornerList::kNear - 2, CornerList::kNear + 2);
  std::vector<Triangle> triangles;
  size_t near_ones = 0;
  bool one_below = false;
  for (size_t n = 0; n < 1001; ++n) {
    Triangle triangle;
    for (Vec3i& v : triangle) v = {anywhere(random), anywhere(random), anywhere(random)};
    const Vec3i low = Shifted(triangle[0], kSubvoxelBits) * kLatticeUnit;
    if (n % 3 != 0) triangle[2] = low + Vec3i{near(random), 5, -7};
    if (n % 3 != 0) triangle[1] = low + Vec3i{8, n % 2 == 0 ? CornerList::kNear - 1 : -CornerList::kNear, 0};
    triangles.push_back(triangle);
  }
  const Vec3i origin{64, 0, 128};
  for (size_t m = 0; m < 3; ++m) triangles.back()[0][m] = origin[m] * kLatticeUnit - static_cast<int32_t>(m != 1);
  const SnappedMesh mesh = MeshOf(triangles);
  for (const Simd simd : SimdHere()) {
    const ForcedSimd forced(simd);
    for (const size_t count : {size_t{1}, size_t{6}, size_t{1001}}) {
      const auto list = std::make_unique<CornerList>();
      SurfaceSums().AddAndList(mesh, triangles.size() - count, count, origin, *list);
      ASSERT_EQ(list->size, count);
      for (size_t place = 0; place < count; ++place) {
        const size_t t = triangles.size() - count + place;
        ASSERT_EQ(list->triangles[place], t);
        const Vec3i voxel = Shifted(triangles[t][0], kSubvoxelBits);
        bool is_near = true;
        for (size_t c = 0; c < 3; ++c) {
          const Vec3i at = triangles[t][c] - voxel * kLatticeUnit, listed = list->Corner(c, place);
          for (size_t m = 0; m < 3; ++m) {
            ASSERT_EQ(listed[m], std::clamp(at[m], int32_t{INT16_MIN}, int32_t{INT16_MAX})) << SimdInUse();
            is_near &= -CornerList::kNear <= at[m] && at[m] < CornerList::kNear;
          }
        }
        for (size_t m = 0; m < 3; ++m) {
          const int32_t from = voxel[m] - origin[m];
          one_below |= from == -1;
          if (from >= -1 && from < CornerList::kVoxels - 1) {
            ASSERT_EQ(list->third_and_voxel[place][4 + m], from + CornerList::kFirstVoxel) << SimdInUse();
          }
        }
        ASSERT_EQ(list->IsNear(place), is_near);
        near_ones += is_near ? 1 : 0;
      }
    }
  }
  EXPECT_GT(near_ones, triangles.size() / 2);
  EXPECT_TRUE(one_below);
}

// Expects the result of Star for each pair. Returns the number of pairs with links.
size_t ExpectStars(const std::vector<Triangle>& triangles, const std::vector<ScanFrame>& frames,
                   const BitsLayout& layout, const std::vector<VoxelTriangle>& pairs, const std::string& what) {
  std::vector<StarLinks> stars(pairs.size());
  FindStarLinks(MeshOf(triangles), frames, layout, pairs, stars.data());
  size_t with_links = 0;
  for (size_t n = 0; n < pairs.size(); ++n) {
    const OrientedTriangle oriented(triangles[pairs[n].triangle]);
    const Star star(oriented, layout.VoxelAt(pairs[n].voxel));
    StarLinks expected{};
    for (size_t d = 0; d < frames.size(); ++d) {
      const Vec3i& q = frames[d].frame.q;
      Vec3i step{};
      if (!star.IsNearerEnd(q, step)) continue;
      expected.nearer |= 1U << d;
      if (step == q) expected.forward |= 1U << d;
    }
    EXPECT_EQ(stars[n].nearer, expected.nearer) << what << " pair " << n << " " << SimdInUse();
    EXPECT_EQ(stars[n].forward, expected.forward) << what << " pair " << n << " " << SimdInUse();
    with_links += expected.nearer != 0 ? 1 : 0;
  }
  return with_links;
}

TEST(StarLinks, SayOfEachPairWhatTheStarSaysOnEachKernel) {
  std::mt19937 random(kSeed);
  const Vec3i tile_min{0, 64, 0};
  const BitsLayout layout(tile_min, {8, 8, 8});
  for (const ExactLattice& l : ExactLattices()) {
    const auto frames = MakeScanFrames(l.lattice.frames(0));
    for (const int32_t size : {60, 400, 9000, 40000, 1 << 19, 1 << 22, 3 << 22}) {
      const auto triangles = TrianglesAround(tile_min, size, 60);
      const SnappedMesh mesh = MeshOf(triangles);
      // Voxels that are within half a step of the plane, as candidates are.
      std::vector<VoxelTriangle> pairs;
      for (uint32_t t = 0; t < triangles.size(); ++t) {
        const OrientedTriangle oriented(triangles[t]);
        if (oriented.normal == Vec<int64_t, 3>{}) continue;
        ScanAlongPrincipal(
            oriented, PrincipalScanFrame(frames, oriented.normal), {tile_min, tile_min + Vec3i{64, 64, 64}},
            [&](const Vec3i& z, const Vec3i&) {
              pairs.push_back({layout.NumberOf(z), t});
            },
            [&](const Vec3i& z) {
              pairs.push_back({layout.NumberOf(z), t});
            });
      }
      std::shuffle(pairs.begin(), pairs.end(), random);  // so that one vector has pairs of all kinds
      if (pairs.size() > 5000) pairs.resize(5000);
      for (const Simd simd : SimdHere()) {
        const ForcedSimd forced(simd);
        ExpectStars(triangles, frames, layout, pairs, std::string(l.name) + " size " + std::to_string(size));
      }
    }
  }
}

// Planes nearly parallel to a direction, and nearly through the voxel. All results of floats are within their error
// bounds.
TEST(StarLinks, OfPlanesAlongDirectionsAreWhatTheStarSaysOnEachKernel) {
  const BitsLayout layout({0, 0, 0}, {8, 8, 8});
  const Vec3i voxel{31, 17, 44};
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<int32_t> off(-1, 1);
  for (const ExactLattice& l : ExactLattices()) {
    const auto frames = MakeScanFrames(l.lattice.frames(0));
    std::vector<Triangle> triangles;
    std::vector<VoxelTriangle> pairs;
    for (const int32_t length : {100, 1000, 10'000, 100'000, 1'000'000}) {
      for (size_t n = 0; n < frames.size(); ++n) {
        const Vec3i q = frames[n].frame.q * length, p = frames[(n + 1) % frames.size()].frame.q * length;
        for (int times = 0; times < Dose(100, 20); ++times) {
          Triangle triangle{q + p, q - p, q * -2};
          for (Vec3i& v : triangle) v = v + voxel * kLatticeUnit + Vec3i{off(random), off(random), off(random)};
          pairs.push_back({layout.NumberOf(voxel), static_cast<uint32_t>(triangles.size())});
          triangles.push_back(triangle);
        }
      }
    }
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      EXPECT_GT(ExpectStars(triangles, frames, layout, pairs, l.name), triangles.size() / 4);
    }
  }
}

// Two edges are nearly parallel, and cross the voxel. Each edge is the shortest one of some triangles.
TEST(StarLinks, OfLongThinTrianglesAreWhatTheStarSaysOnEachKernel) {
  const BitsLayout layout({0, 0, 0}, {8, 8, 8});
  const Vec3i voxel{31, 17, 44};
  std::mt19937 random(kSeed);
  const auto near = [&random](int32_t most) {
    std::uniform_int_distribution<int32_t> entry(-most, most);
    return Vec3i{entry(random), entry(random), entry(random)};
  };
  std::vector<Triangle> triangles;
  std::vector<VoxelTriangle> pairs;
  for (const int32_t width : {3, 10, kLatticeUnit / 8, kLatticeUnit}) {
    for (int times = 0; times < Dose(4000, 400); ++times) {
      const Vec3i center = voxel * kLatticeUnit + near(kLatticeUnit / 2), along = near(100'000);
      Triangle triangle{center + along, center - along, center - along + near(width)};
      std::rotate(triangle.begin(), triangle.begin() + times % 3, triangle.end());
      pairs.push_back({layout.NumberOf(voxel), static_cast<uint32_t>(triangles.size())});
      triangles.push_back(triangle);
    }
  }
  for (const ExactLattice& l : ExactLattices()) {
    const auto frames = MakeScanFrames(l.lattice.frames(0));
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      EXPECT_GT(ExpectStars(triangles, frames, layout, pairs, l.name), triangles.size() / 100);
    }
  }
}

// The distance from this plane, times the normal, is 2^64.
TEST(StarLinks, AreNoneWherePlanesAreFarOnEachKernel) {
  constexpr int32_t kSide = 1 << 24, kAway = 1 << 16;
  const BitsLayout layout({0, 0, 0}, {8, 8, 8});
  const auto frames = MakeScanFrames(Lattice::Named(NamedLattice::kCartesian).frames(0));
  const int32_t low = -kSide / 4;
  const SnappedMesh mesh = MeshOf({{{{low, low, kAway}, {low + kSide, low, kAway}, {low, low + kSide, kAway}}}});
  const VoxelTriangle pair{layout.NumberOf({0, 0, 0}), 0};
  for (const Simd simd : SimdHere()) {
    const ForcedSimd forced(simd);
    StarLinks star;
    FindStarLinks(mesh, frames, layout, {&pair, 1}, &star);
    EXPECT_EQ(star.nearer, 0U) << SimdInUse();
  }
}

TEST(TileBits, FindAndSeparateAreWhatTestSaysOnEachKernel) {
  std::mt19937 random(kSeed);
  const BitsLayout layout({0, 0, 0}, {3, 3, 3});
  const auto last = static_cast<uint32_t>(layout.side[0] * layout.stride[0] - 1);
  std::uniform_int_distribution<uint32_t> number(0, last);
  TileBits bits(layout.Words());
  for (int n = 0; n < 20000; ++n) bits.Set(number(random));
  for (const size_t size : {size_t{0}, size_t{1}, size_t{15}, size_t{16}, size_t{1003}}) {
    std::vector<uint32_t> numbers(size);
    for (uint32_t& n : numbers) n = number(random) | number(random) << kNumberBits;
    std::vector<uint32_t> in, out;
    for (uint32_t n = 0; n < size; ++n) {
      (bits.Test(numbers[n] & kNumberMask) ? in : out).push_back(n);
    }
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      const auto list = [](const NumberList& found) {
        return std::vector<uint32_t>(found.view().begin(), found.view().end());
      };
      NumberList first;
      bits.Find(numbers, true, first);
      EXPECT_EQ(list(first), in) << SimdInUse();
      bits.Find(numbers, false, first);
      EXPECT_EQ(list(first), out) << SimdInUse();
      NumberList in_numbers, in_places, out_places;  // of places, as the others; earlier entries stay
      out_places.Reserve(1);
      out_places.Add(7);
      bits.Separate(numbers, Iota(size), in_numbers, in_places, out_places);
      EXPECT_EQ(list(in_places), in) << SimdInUse();
      ASSERT_EQ(in_numbers.size(), in.size()) << SimdInUse();
      for (size_t n = 0; n < in.size(); ++n) EXPECT_EQ(in_numbers[n], numbers[in[n]]) << SimdInUse();
      std::vector<uint32_t> after_7 = list(out_places);
      ASSERT_EQ(after_7.front(), 7U);
      after_7.erase(after_7.begin());
      EXPECT_EQ(after_7, out) << SimdInUse();
    }
  }
}

TEST(TileBits, SetAllSetsEachNumberOnEachKernel) {
  std::mt19937 random(kSeed);
  const BitsLayout layout({0, 0, 0}, {3, 3, 3});
  const auto last = static_cast<uint32_t>(layout.side[0] * layout.stride[0] - 1);
  std::uniform_int_distribution<uint32_t> number(0, last), step(0, 2);
  for (const size_t size : {size_t{0}, size_t{255}, size_t{256}, size_t{1003}}) {
    TileBits expected(layout.Words());
    std::vector<uint32_t> numbers(size);
    uint32_t at = number(random) / 2;  // many in one word
    for (uint32_t& n : numbers) {
      at += step(random);
      n = size % 2 == 0 ? at : number(random);
      expected.Set(n);
      n |= number(random) << kNumberBits;
    }
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      TileBits bits(layout.Words());
      bits.SetAll(numbers);
      EXPECT_EQ(bits.words(), expected.words()) << SimdInUse();
    }
  }
}

TEST(TileBits, FindFewIsFindForSetsOfAnySizeOnEachKernel) {
  std::mt19937 random(kSeed);
  const BitsLayout layout({0, 0, 0}, {3, 3, 3});
  const auto last = static_cast<uint32_t>(layout.side[0] * layout.stride[0] - 1);
  std::uniform_int_distribution<uint32_t> number(0, last);
  for (const size_t members : {size_t{0}, size_t{1}, size_t{50}, size_t{300}, size_t{5000}}) {
    TileBits bits(layout.Words());
    std::vector<uint32_t> listed, numbers;
    for (size_t n = 0; n < members; ++n) {
      listed.push_back(number(random));
      bits.Set(listed.back());
    }
    for (size_t n = 0; n < members; n += 3) listed.push_back(listed[n]);
    listed.push_back(number(random));  // perhaps no member
    for (uint32_t n = 0; n < 10007; ++n) {
      const uint32_t any = n % 5 == 0 ? listed[n % listed.size()] : number(random);
      numbers.push_back(any | n << kNumberBits);
    }
    std::vector<uint32_t> in;
    for (uint32_t n = 0; n < numbers.size(); ++n) {
      if (bits.Test(numbers[n] & kNumberMask)) in.push_back(n);
    }
    const std::span<const uint32_t> given = std::span(listed).first(members == 0 ? 0 : listed.size());
    NumberList found;
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      found.Reserve(1);
      found.Add(1);  // earlier entries are removed
      bits.FindFew(numbers, given, found);
      EXPECT_EQ(std::vector<uint32_t>(found.view().begin(), found.view().end()), in) << SimdInUse() << " " << members;
    }
  }
}

TEST(CutOut, GivesTheVoxelsOfTheTileAndRegionAsBricksOnEachKernel) {
  std::mt19937 random(kSeed);
  const Vec3i tile_min{64, -128, 0}, base_ijk{-640, 64, 128};
  const IndexBox tile{tile_min, tile_min + Vec3i{kTileSide, kTileSide, kTileSide}};
  for (const auto& [margin, count] : {std::pair<Vec3i, int>{{0, 0, 0}, 3000},
                                      {{3, 3, 3}, 3000},
                                      {{6, 3, 9}, 3000},
                                      {{3, 3, 3}, 40},
                                      {{3, 3, 3}, 0}}) {
    const BitsLayout layout(tile_min, margin);
    std::uniform_int_distribution<uint32_t> number(0, static_cast<uint32_t>(layout.side[0] * layout.stride[0] - 1));
    TileBits bits(layout.Words());
    for (int n = 0; n < count; ++n) bits.Set(number(random));
    for (const IndexBox& region : {tile, IndexBox{tile_min + Vec3i{3, 0, 17}, tile_min + Vec3i{64, 9, 60}}}) {
      std::set<Vec3i> expected;
      for (int32_t i = tile.min[0]; i < tile.max[0]; ++i) {
        for (int32_t j = tile.min[1]; j < tile.max[1]; ++j) {
          for (int32_t k = tile.min[2]; k < tile.max[2]; ++k) {
            if (region.Contains({i, j, k}) && bits.Test(layout.NumberOf({i, j, k}))) expected.insert({i, j, k});
          }
        }
      }
      for (const Simd simd : SimdHere()) {
        const ForcedSimd forced(simd);
        const TileBricks out = CutOut(layout, bits, tile_min, region, base_ijk);
        std::set<Vec3i> found;
        for (const Brick& brick : out.bricks) {
          for (int32_t n = 0; n < 512; ++n) {
            if ((brick.mask[static_cast<size_t>(n >> 6)] >> (n & 63) & 1) == 0) continue;
            found.insert(brick.brick_ijk * kBrickSide + Vec3i{n >> 6, n >> 3 & 7, n & 7} - base_ijk);
          }
        }
        EXPECT_EQ(found, expected) << SimdInUse();
        EXPECT_EQ(out.voxels, expected.size());
        EXPECT_TRUE(std::is_sorted(out.bricks.begin(), out.bricks.end(),
                                   [](const Brick& a, const Brick& b) { return a.brick_ijk < b.brick_ijk; }));
      }
    }
  }
}

}  // namespace
}  // namespace latvox
