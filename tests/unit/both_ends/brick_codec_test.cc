// Packed bricks: the server's encoder, the client's decoder, and the format between them, byte by byte.
#include "client/internal/brick_codec.h"

#include <gmock/gmock.h>
#include <zstd.h>

#include <bit>
#include <cstring>
#include <limits>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/voxelizer/voxelizer.h"
#include "latvox/for_each_voxel.h"
#include "server/wire/brick_codec.h"
#include "tests/unit/both_ends/bricks.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

using client::Decompress;
using client::UnpackBricks;
using client::UnpackKernel;
using testing::HasSubstr;

std::vector<PackKernel> PackKernels() {
  if (BestPackKernel() == PackKernel::kPortable) return {PackKernel::kPortable};
  return {PackKernel::kPortable, BestPackKernel()};
}

std::vector<UnpackKernel> UnpackKernels() {
  if (client::BestUnpackKernel() == UnpackKernel::kPortable) return {UnpackKernel::kPortable};
  return {UnpackKernel::kPortable, client::BestUnpackKernel()};
}

std::string Bytes(std::initializer_list<int> bytes) { return {bytes.begin(), bytes.end()}; }

// The contract's octree by its definition. Returns whether the cube of `side` at (x, y, z) holds a cell. Adds to
// levels[0..2] a byte for each node with a cell. The recursion brings the bytes of a level in Morton order.
bool AddOctree(const BrickMask& mask, int side, int x, int y, int z, std::string* levels) {
  if (side == 1) return Has(mask, x, y, z);
  int byte = 0;
  const int half = side / 2;
  for (int n = 0; n < 8; ++n) {
    const bool child =
        AddOctree(mask, half, x + (n >> 2) * half, y + (n >> 1 & 1) * half, z + (n & 1) * half, levels + 1);
    byte |= child << n;
  }
  if (byte != 0) *levels += static_cast<char>(byte);
  return byte != 0;
}

std::string OctreeOf(const BrickMask& mask) {
  if (CountVoxels(mask) == 512) return std::string(1, '\0');
  std::string levels[3];
  AddOctree(mask, 8, 0, 0, 0, levels);
  return levels[0] + levels[1] + levels[2];
}

std::string Pack(const std::vector<TileBricks>& tiles, PackKernel kernel = BestPackKernel()) {
  std::vector<uint8_t> packed(tiles.size() * kMaxPackedTileBytes);
  uint8_t* end = packed.data();
  for (const TileBricks& tile : tiles) end = PackTile(tile, end, kernel);
  return {packed.data(), end};
}

// Every kernel packs the tiles to the bytes of the format, and unpacks these to the tiles.
void ExpectRoundTrip(const std::vector<TileBricks>& tiles) {
  std::string wanted;
  for (const TileBricks& tile : tiles) {
    wanted.append(reinterpret_cast<const char*>(&tile.tile_ijk), 12);
    BrickMask which = {};
    for (const Brick& brick : tile.bricks) {
      const Vec3i place = brick.brick_ijk - tile.tile_ijk * 8;
      which = With(place[0], place[1], place[2], which);
    }
    wanted += OctreeOf(which);
    for (const Brick& brick : tile.bricks) wanted += OctreeOf(brick.mask);
  }
  for (const PackKernel kernel : PackKernels()) ASSERT_EQ(Pack(tiles, kernel), wanted);
  for (const UnpackKernel kernel : UnpackKernels()) {
    std::vector<client::Brick> bricks;
    ASSERT_EQ(UnpackBricks(wanted, bricks, kernel), absl::OkStatus());
    ExpectSame(bricks, tiles);
  }
}

TEST(PackedFormat, IsTheContractsExampleByteForByte) {
  const TileBricks tile{{1, 0, -1}, {{{8, 0, -1}, With(0, 1, 7, With(6, 1, 7))}}};
  EXPECT_EQ(Pack({tile}), Bytes({0x01, 0,    0,    0,    0,   0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF,  //
                                 0x02, 0x02, 0x02,                                              //
                                 0x22, 0x02, 0x20, 0x08, 0x08}));
}

TEST(PackedFormat, TakesOneByteANodeAndOneForAllCells) {
  BrickMask full;
  full.fill(~uint64_t{0});
  EXPECT_EQ(Pack({TileWith({0, 0, 0}, With(0, 0, 0), full)}), std::string(12, '\0') + Bytes({1, 1, 1, 0}));
  EXPECT_EQ(Pack({TileWith({0, 0, 0}, full, full)}), std::string(12 + 1 + 512, '\0'));
  BrickMask most = full;
  most[7] &= ~(uint64_t{1} << 63);
  EXPECT_EQ(Pack({TileWith({0, 0, 0}, With(0, 0, 0), most)}),
            std::string(12, '\0') + Bytes({1, 1, 1}) + std::string(72, '\xFF') + Bytes({0x7F}));
  EXPECT_EQ(Pack({TileWith({0, 0, 0}, With(7, 7, 7), With(7, 7, 7))}),
            std::string(12, '\0') + Bytes({0x80, 0x80, 0x80, 0x80, 0x80, 0x80}));
  EXPECT_EQ(Pack({TileWith({-2, 0x01020304, 0}, With(4, 2, 1), With(0, 0, 1, With(2, 0, 0)))}),
            Bytes({0xFE, 0xFF, 0xFF, 0xFF, 4, 3, 2, 1, 0, 0, 0, 0}) + Bytes({0x10, 0x04, 0x02}) +
                Bytes({0x01, 0x11, 0x02, 0x01}));
}

TEST(PackedFormat, HoldsEachVoxelAndEachBrick) {
  for (int n = 0; n < 512; n += Dose(1, 7)) {
    const BrickMask one = With(n >> 6, n >> 3 & 7, n & 7);
    BrickMask others = one;
    for (uint64_t& word : others) word = ~word;
    ExpectRoundTrip({TileWith({0, -1, 5}, one, With(1, 2, 3))});
    ExpectRoundTrip({TileWith({0, -1, 5}, With(4, 5, 6), one), TileWith({0, 0, 5}, With(4, 5, 6), others)});
    ExpectRoundTrip({TileWith({0, -1, 5}, others, one)});
  }
}

TEST(PackedFormat, HoldsEachRowOfEightAtEachPlaceAlongEachAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int place = 0; place < 64; place += Dose(1, 9)) {
      TileBricks tile{{0, 0, 0}, {}};
      for (int row = 1; row < 256; ++row) {
        BrickMask mask = {};
        for (int n = 0; n < 8; ++n) {
          int xyz[3] = {place >> 3, place >> 3, place & 7};
          xyz[axis] = n;
          if (axis == 2) xyz[1] = place & 7;
          if (row >> n & 1) mask = With(xyz[0], xyz[1], xyz[2], mask);
        }
        tile.bricks.push_back({{row >> 6, row >> 3 & 7, row & 7}, mask});
      }
      ExpectRoundTrip({tile});
    }
  }
}

TEST(PackedFormat, HoldsBricksOfEveryDensity) {
  std::mt19937_64 random(20261120);
  for (const int percent : {1, 3, 10, 30, 50, 80, 97, 100}) {
    const auto mask = [&] {
      BrickMask result = {};
      for (int n = 0; n < 512; ++n) {
        if (static_cast<int>(random() % 100) < percent) result = With(n >> 6, n >> 3 & 7, n & 7, result);
      }
      result[random() % 8] |= 1;
      return result;
    };
    std::vector<TileBricks> tiles;
    for (int t = 0; t < Dose(20, 6); ++t) {
      tiles.push_back(TileWith({t, -t, 7 * t}, mask(), {}));
      for (Brick& brick : tiles.back().bricks) brick.mask = mask();
    }
    ExpectRoundTrip(tiles);
  }
}

TEST(PackedFormat, HoldsEveryTileOfLatticeCoordinatesAndNoOther) {
  constexpr int32_t kMin = std::numeric_limits<int32_t>::min() >> 6, kMax = std::numeric_limits<int32_t>::max() >> 6;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int32_t good : {kMin, kMin + 1, -1, 0, 1, kMax}) {
      Vec3i tile_ijk{};
      tile_ijk[axis] = good;
      ExpectRoundTrip({TileWith(tile_ijk, With(0, 7, 0, With(7, 0, 7)), With(3, 3, 3))});
    }
    for (const int32_t bad :
         {kMin - 1, kMax + 1, std::numeric_limits<int32_t>::min(), std::numeric_limits<int32_t>::max()}) {
      std::string packed = Pack({TileWith({}, With(0, 0, 0), With(0, 0, 0))});
      std::memcpy(&packed[4 * axis], &bad, sizeof(bad));
      std::vector<client::Brick> bricks;
      EXPECT_THAT(UnpackBricks(packed, bricks).ToString(), HasSubstr("tile coordinate " + std::to_string(bad)));
    }
  }
}

TEST(Bricks, AreCountedFromNoVoxelToAll) {
  client::Brick brick;
  brick.mask = {};
  for (int n = 0; n < 512; ++n) {
    EXPECT_EQ(client::CountVoxels(brick), n);
    const int shuffled = n * 37 % 512;
    brick.mask[shuffled / 64] |= uint64_t{1} << shuffled % 64;
  }
  EXPECT_EQ(client::CountVoxels(brick), 512);
}

// The fast kernel leaves the last octrees, with less room behind them, to the portable code.
TEST(Unpack, RefusesTruncatedBytesAndReadsNothingBeyondThem) {
  const std::string whole = Pack({TileWith({0, 0, 0}, With(1, 2, 3), With(3, 2, 1)), CurvedTile()});
  const size_t first = 12 + 3 + 3;
  for (size_t size = 0; size < whole.size(); ++size) {
    const std::vector<char> part(whole.begin(), whole.begin() + size);  // a vector, so that a sanitizer sees its end
    for (const UnpackKernel kernel : UnpackKernels()) {
      std::vector<client::Brick> bricks;
      const absl::Status status = UnpackBricks({part.data(), part.size()}, bricks, kernel);
      EXPECT_EQ(status.ok(), size == 0 || size == first) << size;
      if (size <= first) continue;
      EXPECT_THAT(status.ToString(), HasSubstr("tile at byte 18 of " + std::to_string(size)));
    }
  }
}

TEST(Unpack, RefusesNodesWithoutCells) {
  const TileBricks tile = CurvedTile();
  const std::string whole = Pack({tile});
  BrickMask which = {};
  for (const Brick& brick : tile.bricks) {
    which = With(brick.brick_ijk[0] & 7, brick.brick_ijk[1] & 7, brick.brick_ijk[2] & 7, which);
  }
  std::set<size_t> roots = {12};  // places where a byte 0 stands for all cells
  size_t end = 12 + OctreeOf(which).size();
  for (const Brick& brick : tile.bricks) {
    roots.insert(end);
    end += OctreeOf(brick.mask).size();
  }
  ASSERT_EQ(end, whole.size());
  for (size_t n = 12; n < whole.size(); ++n) {
    if (roots.contains(n)) continue;
    std::string bad = whole;
    bad[n] = '\0';
    for (const UnpackKernel kernel : UnpackKernels()) {
      std::vector<client::Brick> bricks;
      EXPECT_FALSE(UnpackBricks(bad, bricks, kernel).ok()) << n;
    }
  }
}

// Groups bricks into tiles. Precondition: no tile comes twice in a row.
std::vector<TileBricks> TilesOf(const std::vector<client::Brick>& bricks) {
  std::vector<TileBricks> tiles;
  for (const client::Brick& brick : bricks) {
    const Vec3i tile_ijk{brick.brick_ijk[0] >> 3, brick.brick_ijk[1] >> 3, brick.brick_ijk[2] >> 3};
    if (tiles.empty() || tiles.back().tile_ijk != tile_ijk) tiles.push_back({tile_ijk, {}});
    tiles.back().bricks.push_back({brick.brick_ijk, brick.mask});
  }
  return tiles;
}

// All kernels decode arbitrary bytes alike; bricks that were decoded pack to the same bytes again.
TEST(Unpack, DecodesOrRefusesArbitraryBytes) {
  const std::string whole = Pack({CurvedTile(), TileWith({1, 1, 1}, With(0, 0, 0, With(7, 7, 7)), With(1, 1, 1))});
  std::mt19937_64 random(7);
  int accepted = 0, refused = 0;
  for (int round = 0; round < Dose(20000, 4000); ++round) {
    std::string bad = random() % 4 == 0 ? whole.substr(0, 1 + random() % whole.size()) : whole;
    for (uint64_t changes = random() % 3; changes > 0; --changes) {
      const size_t n = random() % bad.size();
      const auto byte = static_cast<uint8_t>(bad[n]);
      bad[n] = static_cast<char>(random() % 4 == 0 ? random() : std::rotl(byte, 1));  // keeps the number of nodes
    }
    std::vector<client::Brick> bricks, others;
    const absl::Status status = UnpackBricks(bad, bricks, UnpackKernel::kPortable);
    ASSERT_EQ(status, UnpackBricks(bad, others));
    ++(status.ok() ? accepted : refused);
    if (!status.ok()) continue;
    const std::vector<TileBricks> tiles = TilesOf(bricks);
    ExpectSame(others, tiles);
    ASSERT_EQ(Pack(tiles), bad);
  }
  EXPECT_GT(accepted, Dose(1000, 200));
  EXPECT_GT(refused, Dose(1000, 200));
}

TEST(Unpack, RefusesMoreThanABatchMayHold) {
  std::vector<TileBricks> tiles;
  BrickMask full;
  full.fill(~uint64_t{0});
  for (int n = 0; n < 64; ++n) tiles.push_back(TileWith({n, 0, 0}, full, With(0, 0, 0)));
  std::vector<client::Brick> bricks;
  EXPECT_EQ(UnpackBricks(Pack(tiles), bricks), absl::OkStatus());
  ExpectSame(bricks, tiles);
  tiles.push_back(TileWith({64, 0, 0}, With(0, 0, 0), With(0, 0, 0)));
  EXPECT_THAT(UnpackBricks(Pack(tiles), bricks).ToString(), HasSubstr("32769 bricks exceed 32768"));
  EXPECT_THAT(UnpackBricks(std::string((1 << 20) + 1, 'x'), bricks).ToString(),
              HasSubstr("packed has 1048577 bytes, over 1048576"));
}

TEST(Zstd, IsUsedWhereItSavesAnEighth) {
  const std::string surface = Pack(std::vector<TileBricks>(20, CurvedTile()));
  const std::optional<std::string> frame = CompressWherePays(surface);
  ASSERT_TRUE(frame);
  EXPECT_LT(frame->size(), surface.size() * 7 / 8);
  std::string packed;
  EXPECT_EQ(Decompress(*frame, surface.size(), client::kMaxPackedBytes, packed), absl::OkStatus());
  EXPECT_EQ(packed, surface);

  std::string noise(10000, '\0');
  std::mt19937_64 random(1);
  for (char& byte : noise) byte = static_cast<char>(random());
  for (const std::string& hardly : {noise, Pack({TileWith({0, 0, 0}, With(1, 2, 3), With(3, 2, 1))})}) {
    EXPECT_FALSE(CompressWherePays(hardly));
    EXPECT_EQ(CompressWherePays(surface), frame) << "after one that did not fit";
  }
}

TEST(Zstd, RefusesFramesThatAreNotWhatTheySay) {
  const std::string packed = Pack({CurvedTile()});
  const std::string frame = CompressWherePays(packed).value_or("");
  ASSERT_FALSE(frame.empty());
  std::string out;
  for (const size_t other : {packed.size() - 1, packed.size() + 1, size_t{1}}) {
    EXPECT_FALSE(Decompress(frame, other, client::kMaxPackedBytes, out).ok()) << other;
  }
  for (size_t size = 0; size < frame.size(); ++size) {
    EXPECT_FALSE(Decompress(frame.substr(0, size), packed.size(), client::kMaxPackedBytes, out).ok()) << size;
  }
  EXPECT_FALSE(Decompress(packed, packed.size(), client::kMaxPackedBytes, out).ok());
  EXPECT_THAT(Decompress(frame, size_t{1} << 32, client::kMaxPackedBytes, out).ToString(),
              HasSubstr("4294967296 bytes exceed 1048576"));
  EXPECT_LE(out.capacity(), 2u << 20);

  const std::string zeros(64 << 20, '\0');
  std::string bomb(ZSTD_compressBound(zeros.size()), '\0');
  bomb.resize(ZSTD_compress(bomb.data(), bomb.size(), zeros.data(), zeros.size(), 1));
  ASSERT_LT(bomb.size(), 1u << 16);
  EXPECT_FALSE(Decompress(bomb, 1 << 20, client::kMaxPackedBytes, out).ok());
  EXPECT_LE(out.capacity(), 2u << 20);
}

}  // namespace
}  // namespace latvox
