#include "server/brick_batch.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "server/brick_codec.h"

namespace latvox {
namespace {

constexpr size_t kMaskBytes = sizeof(BrickMask);
constexpr size_t kBrickBytes = kMaskBytes + sizeof(Vec3i);
constexpr size_t kMaxTileBricks = 512;

static_assert(kMaskBytes == 64);
static_assert(BrickBatcher::kFullBytes + std::max(kMaxTileBricks * kBrickBytes, kMaxPackedTileBytes) < 1 << 20);
static_assert(std::endian::native == std::endian::little, "masks are sent as they lie in memory");

}  // namespace

void BrickBatcher::Add(const TileBricks& tile) {
  if (encoding_ == BrickEncoding::kMasks) {
    AddMasks(tile);
  } else {
    PackTile(tile, *batch_.mutable_packed());
  }
  bricks_ += tile.bricks.size();
  progress_ = std::clamp(tile.progress, progress_, 1.0);
}

void BrickBatcher::AddMasks(const TileBricks& tile) {
  std::string& masks = *batch_.mutable_masks();
  if (masks.empty()) {
    masks.reserve(full_bytes_);
    batch_.mutable_brick_ijk()->Reserve(static_cast<int>(3 * full_bytes_ / kBrickBytes));
  }
  for (const Brick& brick : tile.bricks) {
    for (int32_t coordinate : brick.brick_ijk) batch_.add_brick_ijk(coordinate);
    masks.append(reinterpret_cast<const char*>(brick.mask.data()), kMaskBytes);
  }
}

bool BrickBatcher::full() const {
  const size_t bytes = encoding_ == BrickEncoding::kMasks ? bricks_ * kBrickBytes : batch_.packed().size();
  return bytes >= full_bytes_ || bricks_ > kMaxBricks - kMaxTileBricks;
}

v1::BrickBatch BrickBatcher::Take() {
  if (encoding_ == BrickEncoding::kPackedZstd) {
    const auto bytes = static_cast<uint32_t>(batch_.packed().size());
    if (CompressWherePays(*batch_.mutable_packed())) batch_.set_packed_bytes(bytes);
  }
  batch_.set_progress(progress_);
  bricks_ = 0;
  full_bytes_ = std::min(2 * full_bytes_, kFullBytes);
  return std::exchange(batch_, {});
}

}  // namespace latvox
