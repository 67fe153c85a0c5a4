// The crossings of tiny triangles and their storage, compared with the crossing rule in every direction.
#include "core/tiny/tiny.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/digitize/crossing.h"
#include "core/tile/tile_links.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/triangles.h"

namespace latvox {
namespace {

// Crossed links, as the numbers of their ends: nearer, farther.
using LinkSet = std::multiset<std::pair<uint32_t, uint32_t>>;

void AddCrossings(const Triangle& triangle, const std::vector<ScanFrame>& frames, const IndexBox& box,
                  const BitsLayout& layout, LinkSet& links) {
  for (const ScanFrame& scan : frames) {
    ForEachCrossing(triangle, scan.frame, box, [&](const Vec3i& nearer, const Vec3i& farther) {
      links.insert({layout.NumberOf(nearer), layout.NumberOf(farther)});
    });
  }
}

// Returns the members of `links` in the box around a tile.
LinkSet Collected(const TileLinks& links, const std::vector<ScanFrame>& frames, const Vec3i& tile_min,
                  const IndexBox& box, const BitsLayout& layout) {
  std::array<int32_t, kPackedDirections> steps{};
  for (size_t n = 0; n < frames.size(); ++n) {
    steps[2 * n + 1] = layout.StepOf(frames[n].frame.q);
    steps[2 * n] = -steps[2 * n + 1];
  }
  LinkSet collected;
  const IndexBox tile{tile_min, tile_min + Vec3i{kTileSide, kTileSide, kTileSide}};
  links.ForEachBatch(tile, box, layout, steps, [&](const Crossings& some) {
    for (size_t n = 0; n < some.nearer.size(); ++n) collected.insert({some.nearer[n], some.farther[n]});
  });
  return collected;
}

void FindAll(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const IndexBox& box, TileLinks& links,
             std::vector<uint32_t>& kept, uint8_t* is_tiny) {
  TinyCrossings crossings(frames, box, links);
  ForEachList(mesh, TinyCrossings::Origin(links), [&](const CornerList& list) { crossings.Find(list, kept, is_tiny); });
}

void ExpectAllLinks(const Vec3i& first_tile, const Vec3i& tile_min) {
  const IndexBox all{tile_min - Vec3i{64, 64, 64}, tile_min + Vec3i{128, 128, 128}};
  for (const ExactLattice& l : ExactLattices()) {
    for (int k : {0, 2}) {
      const auto frames = MakeScanFrames(l.lattice.frames(k));
      const Vec3i reach = ReachOf(frames);
      const IndexBox box{tile_min - reach * 2, tile_min + Vec3i{kTileSide, kTileSide, kTileSide} + reach * 2};
      const BitsLayout layout(tile_min, tile_min - box.min + reach);
      for (const int32_t size : {8, 40, 90, 200}) {
        auto triangles = TrianglesAround(tile_min, size, 3001);
        for (size_t n = 0; n < triangles.size(); n += 50) {  // slivers with a corner that does not fit 16 bits
          triangles[n][1] = triangles[n][0] + Vec3i{1 << 16, 1 << 16, 3};
          triangles[n][2] = triangles[n][0] + Vec3i{40, 60, 5};
        }
        const SnappedMesh mesh = MeshOf(triangles);
        LinkSet expected;
        for (const Triangle& triangle : triangles) AddCrossings(triangle, frames, box, layout, expected);
        for (const Simd simd : SimdHere()) {
          const ForcedSimd forced(simd);
          SCOPED_TRACE(absl::StrCat(l.name, " k ", k, " size ", size, " ", std::string(SimdInUse())));
          // The box lies within the margin of the tile, or reaches beyond it.
          for (const Vec3i& margin : {reach * 2, Vec3i{}}) {
            TileLinks found(first_tile, margin);
            std::vector<uint32_t> others{7};  // earlier entries stay
            FindAll(mesh, frames, all, found, others, nullptr);
            found.Finish();
            ASSERT_EQ(others.front(), 7U);
            others.erase(others.begin());
            ASSERT_TRUE(std::is_sorted(others.begin(), others.end()));
            LinkSet links = Collected(found, frames, tile_min, box, layout);
            if (size <= 40 && simd != Simd::kScalar) {
              EXPECT_LE(others.size(), triangles.size() / 10);
            }
            for (const uint32_t t : others) AddCrossings(triangles[t], frames, box, layout, links);
            ASSERT_EQ(links, expected);
          }
        }
      }
    }
  }
}

TEST(TinyCrossings, AreAllLinksOfTrianglesThatAreNotLeftOverOnEachKernel) { ExpectAllLinks({1, 0, 2}, {128, 64, 192}); }

// Coordinates of voxels, counted from the first tile, take 16 bits.
TEST(TinyCrossings, AreAllLinksFarFromTheFirstTileOnEachKernel) { ExpectAllLinks({0, 0, 0}, {65280, 32704, 65280}); }

TEST(TinyCrossings, LeaveOutWhatLiesOutsideOfTheBoxAndTellWhichTrianglesAreTinyOnEachKernel) {
  const Vec3i tile_min{64, 0, 0};
  const auto frames = MakeScanFrames(Lattice::Named(NamedLattice::kBcc).frames(0));
  const IndexBox box{{70, 3, 10}, {100, 60, 33}};
  const BitsLayout layout(tile_min, ReachOf(frames));
  const auto triangles = TrianglesAround(tile_min, 200, 2001);
  const SnappedMesh mesh = MeshOf(triangles);
  for (const Simd simd : SimdHere()) {
    const ForcedSimd forced(simd);
    SCOPED_TRACE(std::string(SimdInUse()));
    TileLinks found(Shifted(tile_min, kTileBits) - Vec3i{1, 1, 1}, {});
    std::vector<uint32_t> kept;
    std::vector<uint8_t> is_tiny(triangles.size(), 7);
    FindAll(mesh, frames, box, found, kept, is_tiny.data());
    found.Finish();
    LinkSet expected, links = Collected(found, frames, tile_min, box, layout);
    std::set<uint32_t> crossed;
    for (uint32_t t = 0; t < triangles.size(); ++t) {
      ASSERT_LE(is_tiny[t], 1);
      LinkSet own;
      AddCrossings(triangles[t], frames, box, layout, own);
      if (!own.empty()) crossed.insert(t);
      if (is_tiny[t] != 0) expected.merge(own);
    }
    EXPECT_EQ(links, expected);
    EXPECT_EQ(links.empty(), simd == Simd::kScalar);
    ASSERT_TRUE(std::is_sorted(kept.begin(), kept.end()));
    EXPECT_TRUE(std::includes(kept.begin(), kept.end(), crossed.begin(), crossed.end()));
    if (simd != Simd::kScalar) {
      EXPECT_LT(kept.size(), triangles.size());
    }
  }
}

// Links lie in more tiles than are moved together, and in fewer.
TEST(TileLinks, MoveToTheirTilesAndToTheBordersOfThese) {
  for (const auto& [side, margin] :  // side of the cube of tiles with the links; margin of a tile
       {std::pair<int32_t, Vec3i>{1, {2, 3, 5}}, {2, {2, 3, 5}}, {4, {2, 3, 5}}, {2, {kTileSide / 2, 3, 5}}}) {
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      SCOPED_TRACE(absl::StrCat(std::string(SimdInUse()), ", tiles a side: ", side));
      std::mt19937 random(8);
      const auto below = [&](int32_t limit) { return static_cast<int32_t>(random() % static_cast<uint32_t>(limit)); };
      TileLinks links({0, 0, 0}, margin);
      std::array<int32_t, kPackedDirections> steps;
      for (int32_t& step : steps) step = below(2001) - 1000;
      std::vector<std::pair<Vec3i, size_t>> ends;  // with their directions
      for (const size_t count : {1, 15, 16, 700, 3000}) {
        PackedLinks packed;
        packed.Reserve(count);
        for (size_t n = 0; n < count; ++n) {
          Vec3i tile, in_tile;
          for (size_t m = 0; m < 3; ++m) {
            tile[m] = below(side);
            in_tile[m] = below(kTileSide);
          }
          const size_t direction = random() % kPackedDirections;
          ends.push_back({tile * kTileSide + in_tile, direction});
          const auto pack = [](const Vec3i& v, int bits) {
            return static_cast<uint32_t>((v[0] << bits | v[1]) << bits | v[2]);
          };
          packed.tiles.Add(pack(tile, kPackedTileBits));
          packed.links.Add(pack(in_tile, kTileBits) << kPackedEndShift | static_cast<uint32_t>(direction));
        }
        auto part = links.ReservePart();
        part->Move(packed, margin);
        links.ReleasePart(std::move(part));
      }
      links.Finish();
      for (const Vec3i& tile : {Vec3i{}, Vec3i{side - 1, 0, side / 2}}) {
        const Vec3i low = tile * kTileSide, high = low + Vec3i{kTileSide, kTileSide, kTileSide};
        const IndexBox box{low - margin, high + margin};
        const BitsLayout layout(low, margin);
        LinkSet expected, collected;
        for (const auto& [end, direction] : ends) {
          const uint32_t nearer = layout.NumberOf(end);
          if (box.Contains(end)) expected.insert({nearer, nearer + static_cast<uint32_t>(steps[direction])});
        }
        links.ForEachBatch({low, high}, box, layout, steps, [&](const Crossings& some) {
          ASSERT_EQ(some.nearer.size(), some.farther.size());
          for (size_t n = 0; n < some.nearer.size(); ++n) collected.insert({some.nearer[n], some.farther[n]});
        });
        EXPECT_EQ(collected, expected);
      }
    }
  }
}

TEST(TileLinks, CountWhatCubesHold) {
  TileLinks links({-1, 0, 2}, {1, 1, 1});
  const auto tile = [](uint32_t i, uint32_t j, uint32_t k) {
    return i << 2 * kPackedTileBits | j << kPackedTileBits | k;
  };
  const auto add = [&](uint32_t where, size_t count) {
    auto part = links.ReservePart();
    PackedLinks packed;
    packed.Reserve(count);
    for (size_t n = 0; n < count; ++n) {
      packed.tiles.Add(where);
      packed.links.Add(0);
    }
    part->Move(packed, links.margin());
    EXPECT_EQ(packed.size(), 0U);
    links.ReleasePart(std::move(part));
  };
  EXPECT_TRUE(links.empty());
  add(tile(0, 0, 0), 3);
  auto held = links.ReservePart();  // so that the next one gets a new part
  add(tile(1, 0, 1), 20);
  add(tile(0, 0, 0), 4);
  links.ReleasePart(std::move(held));
  add(tile(2, 3, 0), 100);
  links.Finish();
  EXPECT_FALSE(links.empty());
  EXPECT_EQ(links.CountIn({-1, 0, 2}, 0), 7U);
  EXPECT_EQ(links.CountIn({0, 0, 3}, 0), 20U);
  EXPECT_EQ(links.CountIn({0, 1, 2}, 0), 0U);
  EXPECT_EQ(links.CountIn({-1, 0, 2}, 1), 27U);
  EXPECT_EQ(links.CountIn({1, 2, 2}, 1), 100U);
  EXPECT_EQ(links.CountIn({-1, 0, 2}, 2), 127U);
}

}  // namespace
}  // namespace latvox
