// Merged files equal, byte for byte, the files that OpenVDB writes of the whole.
#include <gmock/gmock.h>

#include <bit>

#include "client/grid/brick_tree.h"
#include "client/grid/grid_file.h"
#include "tests/unit/client/merge_parts.h"

namespace latvox::client {
namespace {

using testing::Contains;
using testing::Key;
using testing::Not;
using testing::Pair;

class Merge : public MergeTest {
 protected:
  // Merges `parts`, and compares the file with the one of all `bricks`.
  void Check(
      const std::vector<std::string>& parts, const Bricks& bricks, const Edit& edit = [](openvdb::BoolGrid&) {}) {
    const auto merged = MergeTest::Merge(parts);
    ASSERT_TRUE(merged.ok()) << merged.status();
    Part("whole.vdb", bricks, [&](openvdb::BoolGrid& grid) {
      if (parts.size() > 1) grid.insertMeta("latvox_verified", openvdb::BoolMetadata(false));
      edit(grid);
    });
    ASSERT_EQ(Content("merged.vdb"), Content("whole.vdb"));
    uint64_t voxels = 0;
    for (const Brick& brick : bricks) {
      for (const uint64_t word : brick.mask) voxels += static_cast<uint64_t>(std::popcount(word));
    }
    EXPECT_EQ(merged->voxels, voxels);
    EXPECT_EQ(merged->bricks, bricks.size());
    EXPECT_EQ(merged->digest, MakeCertificate(bricks).digest);
  }

  // Splits the bricks into `count` parts of both formats in turns, and merges them. `part` returns the part of a brick.
  void CheckSplit(const Bricks& bricks, size_t count, const std::function<size_t(size_t)>& part) {
    std::vector<Bricks> split(count);
    for (size_t n = 0; n < bricks.size(); ++n) split[part(n)].push_back(bricks[n]);
    std::vector<std::string> paths;
    for (size_t n = 0; n < count; ++n)
      paths.push_back(Part(std::to_string(n) + (n % 2 == 0 ? ".vdb" : ".nvdb"), split[n]));
    Check(paths, bricks);
  }
};

// Nodes of the tree begin at bricks 0, 16 and 512 of every axis. So there are pairs of bricks with every such border
// between them, and pairs without one, in both orders.
TEST_F(Merge, BricksOnBothSidesOfEveryBorderOfNodes) {
  for (const int32_t border : {-512, -16, 0, 16, 512}) {
    for (int n = 0; n < 27; ++n) {
      const Vec3i step = {n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1};
      if (step == Vec3i{}) continue;
      const Bricks pair = {MakeBrick({border, border, border}),
                           MakeBrick({border + step[0], border + step[1], border + step[2]})};
      CheckSplit(pair, 2, [](size_t brick) { return brick; });
      if (HasFatalFailure()) FAIL() << "border " << border << ", neighbor " << n;
    }
  }
}

TEST_F(Merge, BricksInManyNodesHoweverTheyAreSplit) {
  Bricks bricks;
  constexpr int32_t kAxis[] = {-8192, -513, -512, -17, -16, -1, 0, 15, 16, 511, 512, 8191};
  for (const int32_t i : kAxis) {
    for (const int32_t j : kAxis) {
      for (const int32_t k : kAxis) bricks.push_back(MakeBrick({i, j, k}));
    }
  }
  const size_t all = bricks.size();
  CheckSplit(bricks, 1, [](size_t) { return size_t{0}; });
  CheckSplit(bricks, 2, [all](size_t n) { return n * 2 / all; });
  CheckSplit(bricks, 7, [](size_t n) { return n % 7; });
  CheckSplit(bricks, 7, [](size_t n) { return n * n % 7; });
  CheckSplit(bricks, 64, [](size_t n) { return (n * 0x9E3779B9 >> 7) % 64; });
}

TEST_F(Merge, ADenseNode) {
  Bricks bricks;
  for (int n = 0; n < 4096 + 256; ++n) bricks.push_back(MakeBrick({n >> 8, n >> 4 & 15, n & 15}));
  CheckSplit(bricks, 3, [](size_t n) { return n % 3; });
}

// Full bricks of parts and of the whole are tiles, and full nodes are, too.
TEST_F(Merge, ASolidHoweverItIsSplit) {
  Bricks bricks;
  for (int32_t i = -17; i < 18; ++i) {
    for (int32_t j = -1; j < 17; ++j) {
      for (int32_t k = 495; k < 529; ++k) {
        const bool is_rim = i == -17 || i == 17 || j == -1 || j == 16 || k == 495 || k == 528;
        bricks.push_back(is_rim ? MakeBrick({i, j, k}) : Brick{{i, j, k}, kFullBrick});
      }
    }
  }
  const size_t all = bricks.size();
  CheckSplit(bricks, 1, [](size_t) { return size_t{0}; });
  CheckSplit(bricks, 2, [all](size_t n) { return n * 2 / all; });
  CheckSplit(bricks, 4, [all](size_t n) { return n * 4 / all; });
  CheckSplit(bricks, 7, [](size_t n) { return n % 7; });
}

TEST_F(Merge, HalvesOfBricksAreTilesTogether) {
  Bricks low, high, both;
  for (int32_t n = 0; n < 4096; ++n) {
    const Vec3i ijk = {n >> 8, n >> 4 & 15, n & 15};
    Brick half{ijk, {}};
    half.mask.fill(0x00FF00FF'00FF00FF);
    low.push_back(half);
    half.mask.fill(~half.mask[0]);
    high.push_back(half);
    both.push_back({ijk, kFullBrick});
  }
  Check({Part("a.vdb", low), Part("b.nvdb", high)}, both);
}

// As they were before latvox wrote tiles.
TEST_F(Merge, FullBricksOfAPartMayBeLeaves) {
  const Bricks bricks = {{{0, 0, 0}, kFullBrick}, MakeBrick({0, 0, 1}), {{0, 0, 2}, kFullBrick}};
  Part("a.vdb", bricks);
  VoxelGrid grid(MakeTransform());
  ASSERT_TRUE(grid.Add({bricks, 1}).ok());
  grid.SetCertificate(MakeCertificate(bricks));
  grid.content().grid->tree().voxelizeActiveTiles();
  ASSERT_TRUE(WriteGridFile({grid.content().grid}, Path("old.vdb")).ok());
  ASSERT_GT(Read("old.vdb").size(), Read("a.vdb").size());
  Check({Path("old.vdb")}, bricks);
}

TEST_F(Merge, EachOfTheVoxelsOfABrickAlone) {
  for (int bit = 0; bit < 512; ++bit) {
    Brick brick{{-1, 0, 5}, {}};
    brick.mask[static_cast<size_t>(bit / 64)] = uint64_t{1} << bit % 64;
    CheckSplit({brick}, 1, [](size_t) { return size_t{0}; });
    if (HasFatalFailure()) FAIL() << bit;
  }
}

TEST_F(Merge, NothingAtAll) {
  CheckSplit({}, 1, [](size_t) { return size_t{0}; });
  CheckSplit({}, 3, [](size_t) { return size_t{0}; });
}

TEST_F(Merge, OverlappingPartsAreAUnion) {
  Brick low{{3, -4, 5}, {1, 2, 0, 0, 0, 0, 0, 0}}, high{{3, -4, 5}, {1, 4, 8, 0, 0, 0, 0, 16}};
  const Brick both{{3, -4, 5}, {1, 6, 8, 0, 0, 0, 0, 16}}, other = MakeBrick({3, -4, 6});
  Check({Part("a.vdb", {low, other}), Part("b.vdb", {high})}, {both, other});
  Check({Part("a.vdb", {low}), Part("b.vdb", {high, other}), Part("c.vdb", {other})}, {both, other});
  const auto merged = MergeTest::Merge({Path("a.vdb"), Path("b.vdb"), Path("c.vdb")});
  EXPECT_EQ(merged->shared_bricks, 2u);
}

TEST_F(Merge, ShardsMergeInAnyOrderAndLoseTheirNames) {
  const Bricks bricks = {MakeBrick({0, 0, 0}), MakeBrick({8, 0, 0}), MakeBrick({16, 0, 0})};
  const std::string a = Part("a.vdb", {bricks[0]}, Shard("0/4")), b = Part("b.vdb", {bricks[1]}, Shard("1/4"));
  const std::string c = Part("c.vdb", {bricks[2]}, Shard("2/4")), d = Part("d.vdb", {}, Shard("3/4"));
  Check({a, b, c, d}, bricks);
  Check({d, b, a, c}, bricks);
  EXPECT_THAT(ReadGridFileInfo(Path("merged.vdb"))->metadata, Not(Contains(Key("latvox_shard"))));
  Check({Part("only.vdb", bricks, Shard("0/1"))}, bricks);
}

TEST_F(Merge, WarningsOfAllPartsHoldForTheWholeExceptEmptyResults) {
  const Bricks bricks = {MakeBrick({0, 0, 0}), MakeBrick({1, 0, 0})};
  const auto warn = [](const std::string& text) {
    return [=](openvdb::BoolGrid& grid) { grid.insertMeta("latvox_warnings", openvdb::StringMetadata(text)); };
  };
  const std::string a = Part("a.vdb", {bricks[0]}, warn(R"([{"code":"A"},{"code":"B"}])"));
  const std::string b =
      Part("b.vdb", {bricks[1]}, warn(R"([{"code":"A"},{"code":"EMPTY_RESULT"},{"code":"EMPTY_SHARD"},{"code":"C"}])"));
  Check({a, b}, bricks, warn(R"([{"code":"A"},{"code":"B"},{"code":"C"}])"));
  Check({Part("c.vdb", {}, warn(R"([{"code":"EMPTY_RESULT"}])")), Part("d.vdb", {bricks[0]})}, {bricks[0]});
}

TEST_F(Merge, FactsOfEveryPartHoldForTheWholeExceptVerification) {
  const Bricks bricks = {MakeBrick({0, 0, 0}), MakeBrick({1, 0, 0})};
  const auto set = [](const char* name, bool value) {
    return [=](openvdb::BoolGrid& grid) { grid.insertMeta(name, openvdb::BoolMetadata(value)); };
  };
  for (const char* name : {"latvox_tunnel_free", "latvox_minimal"}) {
    const std::string a = Part("a.vdb", {bricks[0]}, set(name, false)), b = Part("b.vdb", {bricks[1]});
    Check({a, b}, bricks, set(name, false));
    Check({b, a}, bricks, set(name, false));
  }
  const std::string a = Part("a.vdb", {bricks[0]}, set("latvox_verified", true));
  const std::string b = Part("b.vdb", {bricks[1]}, set("latvox_verified", true));
  Check({a, b}, bricks);
  Check({a}, {bricks[0]}, set("latvox_verified", true));
}

TEST_F(Merge, ShardsAreMinimalTogetherIfTheWholeIsAndOtherPartsMayNotBeAll) {
  const Bricks bricks = {MakeBrick({0, 0, 0}), MakeBrick({1, 0, 0})};
  for (const bool whole_minimal : {true, false}) {
    const auto with = [&](const std::string& shard, bool minimal) {
      return [=](openvdb::BoolGrid& grid) {
        if (!shard.empty()) Shard(shard)(grid);
        grid.insertMeta("latvox_minimal", openvdb::BoolMetadata(minimal));
        grid.insertMeta("latvox_whole_minimal", openvdb::BoolMetadata(whole_minimal));
      };
    };
    Check({Part("a.vdb", {bricks[0]}, with("0/2", false)), Part("b.vdb", {bricks[1]}, with("1/2", false))}, bricks,
          with("", whole_minimal));
    Check({Part("a.vdb", {bricks[0]}, with("", false)), Part("b.vdb", {bricks[1]}, with("", false))}, bricks,
          with("", false));
  }
}

TEST_F(Merge, TheWholeHasTheBoxesOfAllPartsAndTheRequestIfItIsTheSame) {
  const Bricks bricks = {MakeBrick({0, 0, 0}), MakeBrick({1, 0, 0})};
  const auto with = [](const std::string& region, const std::string& request) {
    return [=](openvdb::BoolGrid& grid) {
      if (!region.empty()) grid.insertMeta("latvox_region", openvdb::StringMetadata(region));
      if (!request.empty()) grid.insertMeta("latvox_request", openvdb::StringMetadata(request));
    };
  };
  const auto part = [&](const char* name, size_t n, const std::string& region, const std::string& request) {
    return Part(name, {bricks[n]}, with(region, request));
  };
  Check({part("a.vdb", 0, "1,2", "x"), part("b.vdb", 1, "3,4", "x")}, bricks, with("1,2; 3,4", "x"));
  Check({part("a.vdb", 0, "1,2", "x"), part("b.vdb", 1, "1,2", "y")}, bricks, with("1,2", ""));
  Check({part("a.vdb", 0, "1,2", "x"), part("b.vdb", 1, "", "x")}, bricks, with("", "x"));
}

TEST_F(Merge, ProgressGrowsToItsEndAndCancellingStops) {
  Bricks bricks;
  for (int n = 0; n < 20000; ++n) bricks.push_back(MakeBrick({n / 400, n / 20 % 20, n % 20}));
  const std::string part = Part("a.vdb", bricks);
  double share = 0;
  int calls = 0;
  const auto watch = [&](double now, uint64_t written) {
    EXPECT_LE(share, now);
    EXPECT_NEAR(now * 20000, static_cast<double>(written), 300);
    share = now, ++calls;
  };
  ASSERT_TRUE(MergeParts({part}, Path("m.vdb"), Cancellation(), watch).ok());
  EXPECT_GT(calls, 10);
  EXPECT_GT(share, 0.9);
  EXPECT_LE(share, 1);
  for (const int at : {1, calls / 2, calls}) {  // even the last call comes before the last bytes
    const Cancellation cancellation;
    const auto cancel = [&, call = 0](double, uint64_t) mutable {
      if (++call == at) cancellation.Cancel();
    };
    const auto merged = MergeParts({part}, Path("m.vdb"), cancellation, cancel);
    EXPECT_EQ(merged.status().code(), absl::StatusCode::kCancelled);
  }
}

}  // namespace
}  // namespace latvox::client
