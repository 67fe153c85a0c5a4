// The file of a set equals, byte for byte, the one that OpenVDB writes.
#include "client/grid/voxel_file.h"

#include <gmock/gmock.h>

#include <cmath>
#include <memory>
#include <sstream>
#include <vector>

#include "client/grid/grid_metadata.h"
#include "client/grid/grid_transform.h"
#include "client/grid/openvdb_metadata.h"
#include "client/grid/part_file.h"
#include "latvox/lattice.h"
#include "tests/unit/client/merge_parts.h"

namespace latvox::client {
namespace {

class VoxelFile : public MergeTest {
 protected:
  // Writes the bricks in this order, and compares the file with that of OpenVDB.
  void Check(const Bricks& bricks, const GridTransform& transform = MakeTransform()) {
    BrickTree tree;
    tree.Add(bricks);
    VoxelGrid grid(transform);
    ASSERT_TRUE(grid.Add({bricks, 1}).ok());
    Check(tree, grid, transform);
  }

  void Check(LowerNodes& nodes, VoxelGrid& grid, const GridTransform& transform) {
    const Certificate certificate = MakeCertificate({});
    grid.SetCertificate(certificate);
    ASSERT_TRUE(grid.Write(Path("theirs.vdb")).ok());
    Metadata metadata = PlaceMetadata(transform);
    metadata.merge(CertificateMetadata(certificate));
    metadata["name"] = ToMetadata("voxels");
    const auto describe = [&](const VoxelCounts& counts) {
      EXPECT_EQ(counts.voxels, grid.CountActiveVoxels());
      return metadata;
    };
    const absl::Status written = WriteVoxelFile(nodes, TransformBytes(transform), describe, Path("ours.vdb"));
    ASSERT_TRUE(written.ok()) << written;
    ASSERT_EQ(Read("ours.vdb"), Read("theirs.vdb"));
    const auto read = ReadGridFileInfo(Path("ours.vdb"));
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_EQ(read->active_voxels, grid.CountActiveVoxels());
  }

  static Bricks FullBox(const Vec3i& low, const Vec3i& sides) {
    Bricks bricks;
    for (int32_t i = 0; i < sides[0]; ++i) {
      for (int32_t j = 0; j < sides[1]; ++j) {
        for (int32_t k = 0; k < sides[2]; ++k) bricks.push_back({{low[0] + i, low[1] + j, low[2] + k}, kFullBrick});
      }
    }
    return bricks;
  }
};

TEST_F(VoxelFile, EachTransformIsTheMapThatOpenVdbChooses) {
  const Vec3d zero{}, far = {1000, -2, 3e-5};
  std::vector<Basis> bases = {{{0.3, 0, 0}, {0, -0.1, 0}, {0, 0, 7}},                    // boxes
                              {{0.3, 1e-16, 0}, {0, 0.3 + 1e-16, -1e-17}, {0, 0, 0.3}},  // nearly cubes
                              {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}};                        // turned cubes
  for (const NamedBasis& named : kNamedLattices) bases.push_back(named.basis);
  for (const NamedBasis& named : kNamedLattices) {
    bases.push_back(named.basis);
    for (Vec3d* const step : {&bases.back().a, &bases.back().b, &bases.back().c}) {
      for (double& x : *step) x *= 0.37;
    }
  }
  for (const Basis& basis : bases) {
    for (const Vec3d& origin : {zero, far}) {
      const GridTransform transform{basis, origin, 0.3};
      Check({MakeBrick({1, 2, 3})}, transform);
      if (HasFatalFailure()) FAIL();
      // As OpenVDB itself makes it.
      const auto& [a, b, c] = basis;
      const openvdb::Mat4d matrix(a[0], a[1], a[2], 0., b[0], b[1], b[2], 0., c[0], c[1], c[2], 0., 0., 0., 0., 1.);
      openvdb::math::Transform theirs(std::make_shared<openvdb::math::AffineMap>(matrix));
      if (origin != zero) theirs.postTranslate(openvdb::Vec3d(origin.data()));
      std::ostringstream bytes;
      theirs.write(bytes);
      EXPECT_EQ(bytes.str(), TransformBytes(transform));
    }
  }
}

TEST_F(VoxelFile, TransformsThatOpenVdbRefuses) {
  const auto cubes = [](double side) { return GridTransform{{{side, 0, 0}, {0, side, 0}, {0, 0, side}}, {}, side}; };
  EXPECT_TRUE(CheckGridTransform(cubes(1.5e-5)).ok());
  EXPECT_FALSE(CheckGridTransform(cubes(1.4e-5)).ok());
  EXPECT_THROW(openvdb::math::ScaleMap(openvdb::Vec3d(1.4e-5)), openvdb::ArithmeticError);
  EXPECT_FALSE(CheckGridTransform(cubes(std::nan(""))).ok());
}

TEST_F(VoxelFile, NothingAtAll) { Check(Bricks{}); }

TEST_F(VoxelFile, BricksOnBothSidesOfEveryBorderOfNodes) {
  Bricks bricks;
  constexpr int32_t kAxis[] = {8191, -8192, -513, -512, -17, -16, -1, 0, 15, 16, 511, 512};
  for (const int32_t i : kAxis) {
    for (const int32_t j : kAxis) {
      for (const int32_t k : kAxis) bricks.push_back(MakeBrick({i, j, k}));
    }
  }
  Check(bricks);
  Check({bricks.rbegin(), bricks.rend()});
  for (const Brick& brick : Bricks(bricks.begin(), bricks.begin() + 50)) Check({brick});
}

TEST_F(VoxelFile, TheBoxOfEachVoxelAlone) {
  for (uint32_t bit = 0; bit < 512; ++bit) {
    Brick brick{{-1, 0, 5}, {}};
    brick.mask[bit / 64] = uint64_t{1} << bit % 64;
    Check({brick});
    if (HasFatalFailure()) FAIL() << bit;
  }
}

TEST_F(VoxelFile, FullBricksAreTiles) {
  const Bricks node = FullBox({-16, 0, 512}, {16, 16, 16});
  for (const size_t tiles : {1, 2, 16, 47, 48, 127, 128, 129, 255, 256, 1000, 4095, 4096}) {
    Bricks bricks(node.begin(), node.begin() + static_cast<std::ptrdiff_t>(tiles));
    Check(bricks);
    if (HasFatalFailure()) FAIL() << tiles;
    bricks.push_back(MakeBrick({-17, 0, 512}));
    bricks.push_back(MakeBrick({-1, 15, 527}));
    Check(bricks);
    if (HasFatalFailure()) FAIL() << tiles;
  }
}

TEST_F(VoxelFile, FullLowerNodesAreTilesOfUpperNodes) {
  Check(FullBox({-32, -16, 496}, {48, 32, 32}));  // tiles in four upper nodes, which have nothing else
  Check(FullBox({-33, -17, -3}, {50, 34, 36}));   // and bricks around them
}

TEST_F(VoxelFile, BricksThatComeTwiceAreAUnion) {
  Brick low = MakeBrick({3, -4, 5}), high = low, full = low;
  low.mask[0] = 1, high.mask[0] = ~uint64_t{1}, full.mask = kFullBrick;
  Check({low, MakeBrick({3, -4, 6}), high, MakeBrick({3, -4, 7})});
  for (size_t word = 1; word < 8; ++word) low.mask[word] = kAllVoxels;
  Check({low, MakeBrick({3, -4, 6}), high});  // together they are full
  EXPECT_EQ(ReadGridFile(Path("ours.vdb"))->bricks[0].mask, kFullBrick);
  Check({full, low, full});
}

// Upper nodes whose lower nodes are all full: the first one's alone, and with one brick more.
class FullNodes final : public LowerNodes {
 public:
  explicit FullNodes(std::vector<std::shared_ptr<const LowerNode>> others) : others_(std::move(others)) {}
  void Rewind() override { next_ = 0; }
  std::shared_ptr<const LowerNode> Next() override {
    const uint32_t n = next_++;
    if (n >= kLowersOfUpper) return n - kLowersOfUpper < others_.size() ? others_[n - kLowersOfUpper] : nullptr;
    auto node = std::make_shared<LowerNode>(full_);
    node->upper = {-4096, 0, 8192};
    node->number = n;
    return node;
  }

 private:
  static LowerNode Full() {
    LowerNode node({}, 0);
    for (uint32_t n = 0; n < kBricksOfLower; ++n) node.Add(n, kFullBrick);
    return node;
  }

  const LowerNode full_ = Full();
  const std::vector<std::shared_ptr<const LowerNode>> others_;
  uint32_t next_ = 0;
};

TEST_F(VoxelFile, FullUpperNodesAreTilesOfTheRoot) {
  const auto other = std::make_shared<LowerNode>(Vec3i{0, -4096, 0}, 7);
  other->Add(9, MakeBrick({}).mask);
  for (const bool is_alone : {true, false}) {
    FullNodes nodes(is_alone ? std::vector<std::shared_ptr<const LowerNode>>{}
                             : std::vector<std::shared_ptr<const LowerNode>>{other});
    VoxelGrid grid(MakeTransform());
    grid.content().grid->tree().addTile(/*level=*/3, openvdb::Coord(-4096, 0, 8192), true, true);
    if (!is_alone) {
      const Brick brick{BrickAt({other->upper, 7, 9}), MakeBrick({}).mask};
      ASSERT_TRUE(grid.Add({std::vector{brick}, 1}).ok());
    }
    Check(nodes, grid, MakeTransform());
    ASSERT_TRUE(grid.WriteNano(Path("theirs.nvdb")).ok());
    for (const char* name : {"ours.vdb", "theirs.nvdb"}) {
      const auto part = PartFile::Open(Path(name));
      ASSERT_TRUE(part.ok()) << part.status();
      for (int32_t n = 0; n < 3; ++n) {
        const Brick* const brick = (*part)->Next();
        ASSERT_NE(brick, nullptr) << (*part)->status();
        EXPECT_EQ(brick->brick_ijk, (Vec3i{-512, 0, 1024 + n}));
        EXPECT_EQ(brick->mask, kFullBrick);
      }
    }
  }
}

TEST_F(VoxelFile, APlaceAndItsBrickAreTheSame) {
  for (const Vec3i& brick :
       {Vec3i{0, 0, 0}, Vec3i{-1, 15, 16}, Vec3i{511, -512, 512}, Vec3i{-268435456, 268435455, -7}}) {
    EXPECT_EQ(BrickAt(PlaceOf(brick)), brick);
  }
}

TEST_F(VoxelFile, AFileThatCannotBeWritten) {
  BrickTree tree;
  for (const std::string& path : {std::string("/dev/full"), Path("missing/m.vdb")}) {
    const auto written = WriteVoxelFile(
        tree, TransformBytes(MakeTransform()),
        [](const VoxelCounts&) {
          return Metadata{{"name", ToMetadata("voxels")}};
        },
        path);
    EXPECT_EQ(written.code(), absl::StatusCode::kUnknown);
    EXPECT_THAT(std::string(written.message()), testing::HasSubstr(path + ": cannot be written"));
  }
}

TEST_F(VoxelFile, CancellingEndsEachPass) {
  class Cancelling final : public LowerNodes {
   public:
    Cancelling(BrickTree& tree, uint32_t at, const Cancellation& cancellation)
        : tree_(tree), at_(at), cancellation_(cancellation) {}
    uint32_t taken() const { return taken_; }
    void Rewind() override { tree_.Rewind(); }
    std::shared_ptr<const LowerNode> Next() override {
      if (++taken_ == at_) cancellation_.Cancel();
      return tree_.Next();
    }

   private:
    BrickTree& tree_;
    const uint32_t at_;
    const Cancellation& cancellation_;
    uint32_t taken_ = 0;
  };
  BrickTree tree;
  for (int32_t n = 0; n < 20; ++n) tree.Add(Bricks{MakeBrick({16 * n, 0, 0})});
  constexpr uint32_t kNodesAndEnd = 21;
  for (uint32_t pass = 0; pass < 3; ++pass) {
    const Cancellation cancellation;
    Cancelling nodes(tree, pass * kNodesAndEnd + 5, cancellation);
    const auto written = WriteVoxelFile(
        nodes, TransformBytes(MakeTransform()),
        [](const VoxelCounts&) {
          return Metadata{{"name", ToMetadata("voxels")}};
        },
        Path("cancelled.vdb"), cancellation);
    EXPECT_EQ(written.code(), absl::StatusCode::kCancelled) << written;
    EXPECT_EQ(nodes.taken(), pass * kNodesAndEnd + 5);
  }
}

}  // namespace
}  // namespace latvox::client
