// Batches of bricks and their fields, from the server's tiles to the client's bricks.
#include "server/wire/brick_batch.h"

#include <gtest/gtest.h>

#include <cstring>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "client/internal/brick_codec.h"
#include "core/lattice/grid.h"
#include "core/snap/mesh_range.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/both_ends/bricks.h"

namespace latvox {
namespace {

using client::Decompress;
using client::UnpackBricks;

// Passes all bricks of a job through batches of this encoding, and compares them with those of the job.
void ExpectWholeJob(NamedLattice name, int separability, BrickEncoding encoding) {
  TriangleMesh mesh{{{0, 0, 0}, {90, 13, 31}, {7, 88, -20}, {35, 23, 97}},
                    {{{0, 1, 2}}, {{0, 3, 1}}, {{1, 3, 2}}, {{0, 2, 3}}}};
  const auto grid = ResolveGrid(Lattice::Named(name), {.resolution = 200}, std::nullopt, BoundsOf(mesh));
  ASSERT_TRUE(grid.ok());
  const auto job = VoxelizeJob::Create(mesh, *grid, {.separability = separability});
  ASSERT_TRUE(job.ok()) << job.status();
  std::vector<TileBricks> tiles;
  std::vector<client::Brick> bricks;
  BrickBatcher batcher(encoding);
  const auto take = [&] {
    v1::BrickBatch batch = batcher.Release();
    EXPECT_EQ(batch.brick_ijk_size(), 0);
    EXPECT_EQ(batch.packed_bytes() != 0, encoding == BrickEncoding::kPackedZstd);
    std::string packed = batch.packed();
    if (batch.packed_bytes() != 0) {
      ASSERT_EQ(Decompress(batch.packed(), batch.packed_bytes(), client::kMaxPackedBytes, packed), absl::OkStatus());
    }
    std::vector<client::Brick> part;
    ASSERT_EQ(UnpackBricks(packed, part), absl::OkStatus());
    bricks.insert(bricks.end(), part.begin(), part.end());
  };
  ASSERT_TRUE((*job)
                  ->Advance([&](TileBricks&& tile) {
                    batcher.Add(tile);
                    tiles.push_back(std::move(tile));
                    if (batcher.full()) take();
                    return true;
                  })
                  .ok());
  take();
  ExpectSame(bricks, tiles);
  EXPECT_GT(bricks.size(), 1000u);
}

TEST(PackedBatches, HoldARealJobOnEachLattice) {
  for (const NamedLattice name :
       {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc, NamedLattice::kHexagonal}) {
    for (const int separability : {0, 2}) {
      ExpectWholeJob(name, separability, BrickEncoding::kPacked);
      ExpectWholeJob(name, separability, BrickEncoding::kPackedZstd);
    }
  }
}

TEST(PackedBatches, BeginSmallAndThenHaveAQuarterToOneMebibyte) {
  for (const BrickEncoding encoding : {BrickEncoding::kPacked, BrickEncoding::kPackedZstd}) {
    BrickBatcher batcher(encoding);
    std::vector<size_t> sizes;
    TileBricks tile = CurvedTile();
    while (sizes.size() < 8) {
      ++tile.tile_ijk[0];
      for (Brick& brick : tile.bricks) brick.brick_ijk[0] += 8;
      batcher.Add(tile);
      if (batcher.full()) sizes.push_back(batcher.Release().ByteSizeLong());
    }
    EXPECT_LT(sizes[0], 100u << 10);
    for (size_t n = 3; n < sizes.size(); ++n) {
      EXPECT_GE(sizes[n], 256u << 10);
      EXPECT_LE(sizes[n], 1u << 20);
    }
  }
}

// A full tile with these fields, whose bytes are those of a counter.
TileBricks FullTile(const FieldList& fields) {
  BrickMask full;
  full.fill(~uint64_t{0});
  TileBricks tile = TileWith({7, 0, 0}, full, full);
  tile.voxels = uint64_t{512} * 512;
  for (const Field field : fields) {
    std::vector<std::byte>& bytes =
        tile.fields.emplace_back(tile.voxels * FactsOf(field).bytes(kMostNeighbors, kMostFractionLabels));
    for (size_t n = 0; n < bytes.size(); ++n) bytes[n] = static_cast<std::byte>(n * 2654435761U >> 24);
  }
  return tile;
}

// All fields together take 109 megabytes a tile.
TEST(Batches, HoldTheFieldsOfTheirBricksAndEndBeforeTheirLimit) {
  FieldList all;
  for (const FieldFacts& row : kFields) all.Add(row.field);
  for (const FieldList& fields : {FieldList{Field::kDistance}, FieldList{Field::kNormal}, all}) {
    BrickBatcher batcher(BrickEncoding::kPacked);
    const TileBricks tile = FullTile(fields);
    const std::vector<TileBricks> parts = BrickBatcher::PartsOf(tile);
    EXPECT_EQ(parts.size() > 1, fields == all);
    std::vector<std::string> values(fields.size());
    std::vector<client::Brick> bricks;
    for (const TileBricks& part : parts) {
      batcher.Add(part);
      EXPECT_TRUE(batcher.full() || (parts.size() > 1 && &part == &parts.back()));
      const v1::BrickBatch batch = batcher.Release(&part != &parts.back());
      EXPECT_EQ(batch.tile_continues(), &part != &parts.back());
      EXPECT_LE(batch.ByteSizeLong(), size_t{4} << 20);
      std::vector<client::Brick> some;
      EXPECT_EQ(UnpackBricks(batch.packed(), some), absl::OkStatus());
      bricks.insert(bricks.end(), some.begin(), some.end());
      ASSERT_EQ(batch.fields_size(), static_cast<int>(fields.size()));
      for (size_t n = 0; n < values.size(); ++n) values[n] += batch.fields(static_cast<int>(n)).values();
    }
    ExpectSame(bricks, {tile});
    for (size_t n = 0; n < values.size(); ++n) {
      EXPECT_EQ(values[n], std::string(reinterpret_cast<const char*>(tile.fields[n].data()), tile.fields[n].size()));
    }
  }
}

// Distances of neighbors have the same first bytes, and parts are mostly the same.
TEST(Batches, CompressFieldsWhereItPays) {
  const FieldList fields{Field::kPart, Field::kDistance, Field::kTriangle};
  TileBricks tile = FullTile(fields);
  std::fill(tile.fields[0].begin(), tile.fields[0].end(), std::byte{1});
  for (size_t n = 0; n < tile.voxels; ++n) {
    const float distance = 1 + static_cast<float>(n % 512) / 1024;
    std::memcpy(&tile.fields[1][4 * n], &distance, sizeof(distance));
  }
  std::mt19937 random(3);
  for (std::byte& byte : tile.fields[2]) byte = static_cast<std::byte>(random());
  BrickBatcher batcher(BrickEncoding::kPackedZstd);
  batcher.Add(tile);
  const v1::BrickBatch batch = batcher.Release();
  EXPECT_LT(batch.fields(0).values().size(), 1000U);
  EXPECT_LT(batch.fields(1).values().size(), tile.fields[1].size() / 2);
  EXPECT_EQ(batch.fields(2).plain_bytes(), 0U);
  for (int n = 0; n < 2; ++n) {
    const size_t size = tile.fields[static_cast<size_t>(n)].size();
    EXPECT_EQ(batch.fields(n).plain_bytes(), size);
    std::string planes;
    ASSERT_EQ(Decompress(batch.fields(n).values(), size, client::kMaxFieldBytes, planes), absl::OkStatus());
    for (size_t voxel = 0; voxel < tile.voxels; voxel += 77) {
      for (size_t byte = 0; byte < 4; ++byte) {
        EXPECT_EQ(static_cast<std::byte>(planes[byte * tile.voxels + voxel]),
                  tile.fields[static_cast<size_t>(n)][4 * voxel + byte]);
      }
    }
  }
}

TEST(PackedBatches, NeverHoldMoreBricksThanTheContractAllows) {
  BrickBatcher batcher(BrickEncoding::kPacked);
  BrickMask full;
  full.fill(~uint64_t{0});
  for (int n = 0, batches = 0; batches < 6; ++n) {
    batcher.Add(TileWith({n, 0, 0}, full, With(0, 0, 0)));
    if (!batcher.full()) continue;
    ++batches;
    std::vector<client::Brick> bricks;
    EXPECT_EQ(UnpackBricks(batcher.Release().packed(), bricks), absl::OkStatus());
  }
}

}  // namespace
}  // namespace latvox
