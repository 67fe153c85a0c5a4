// A foreign server's packed bricks. Every kernel unpacks the same bricks, and they are the same again after packing and
// unpacking.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include "client/internal/brick_codec.h"
#include "server/wire/brick_codec.h"

namespace {

using latvox::client::Brick;
using latvox::client::UnpackBricks;

void Require(bool condition) {
  if (!condition) std::abort();
}

bool Same(const std::vector<Brick>& a, const std::vector<Brick>& b) {
  if (a.size() != b.size()) return false;
  for (size_t n = 0; n < a.size(); ++n) {
    if (a[n].brick_ijk != b[n].brick_ijk || a[n].mask != b[n].mask) return false;
  }
  return true;
}

// The bricks as the server packs them: a tile for each run of bricks in one tile, in order.
std::string Repack(const std::vector<Brick>& bricks) {
  std::string packed;
  for (size_t n = 0; n < bricks.size();) {
    const auto& [i, j, k] = bricks[n].brick_ijk;
    latvox::TileBricks tile{{i >> 3, j >> 3, k >> 3}, {}};
    const auto belongs = [&tile](const Brick& brick) {
      const auto& [bi, bj, bk] = brick.brick_ijk;
      return latvox::Vec3i{bi >> 3, bj >> 3, bk >> 3} == tile.tile_ijk &&
             (tile.bricks.empty() || tile.bricks.back().brick_ijk < brick.brick_ijk);
    };
    for (; n < bricks.size() && belongs(bricks[n]); ++n) tile.bricks.push_back({bricks[n].brick_ijk, bricks[n].mask});
    std::vector<uint8_t> room(latvox::kMaxPackedTileBytes);
    packed.append(room.data(), latvox::PackTile(tile, room.data()));
  }
  return packed;
}

void Check(std::string_view packed) {
  std::vector<Brick> bricks, others;
  const absl::Status status = UnpackBricks(packed, bricks);
  Require(status == UnpackBricks(packed, others, latvox::client::UnpackKernel::kPortable));
  if (!status.ok()) return;
  Require(Same(bricks, others));
  const std::string repacked = Repack(bricks);
  Require(repacked.size() <= packed.size());  // smaller if a tile occurs twice in a row
  Require(UnpackBricks(repacked, others).ok() && Same(bricks, others));
}

}  // namespace

// Input: BrickBatch.packed_bytes in four bytes, then packed.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  uint32_t packed_bytes;
  if (size < sizeof(packed_bytes)) return 0;
  std::memcpy(&packed_bytes, data, sizeof(packed_bytes));
  const std::string_view packed(reinterpret_cast<const char*>(data) + sizeof(packed_bytes),
                                size - sizeof(packed_bytes));
  std::string decompressed;
  if (packed_bytes == 0) {
    Check(packed);
  } else if (latvox::client::Decompress(packed, packed_bytes, latvox::client::kMaxPackedBytes, decompressed).ok()) {
    Require(decompressed.size() == packed_bytes);
    Check(decompressed);
  }
  return 0;
}
