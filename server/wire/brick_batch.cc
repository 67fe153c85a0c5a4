#include "server/wire/brick_batch.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/attributes/attributes.h"
#include "server/wire/brick_codec.h"

namespace latvox {
namespace {

constexpr size_t kMaskBytes = sizeof(BrickMask);
constexpr size_t kBrickBytes = kMaskBytes + sizeof(Vec3i);
constexpr size_t kMaxTileBricks = 512;

static_assert(kMaskBytes == 64);
static_assert(BrickBatcher::kFullBytes + std::max(kMaxTileBricks * kBrickBytes, kMaxPackedTileBytes) < 1 << 20);
constexpr size_t kMaxTileValueBytes = kMaxTileBricks * 512 * sizeof(float);
static_assert(BrickBatcher::kFullBytes + kMaxTileValueBytes < 2 << 20, "the contract's limit of values");
constexpr size_t kMaxTileAttributeBytes = kMaxTileBricks * 512 * kMaxAttributes * sizeof(uint32_t);
static_assert(BrickBatcher::kFullBytes + kMaxTileAttributeBytes <= 3670016, "the contract's limit of attributes");
static_assert(std::endian::native == std::endian::little, "masks and values are sent as they lie in memory");

}  // namespace

void BrickBatcher::Add(const TileBricks& tile) {
  encoding_ == BrickEncoding::kMasks ? AddMasks(tile) : AddPacked(tile);
  batch_.mutable_values()->append(reinterpret_cast<const char*>(tile.values.data()),
                                  tile.values.size() * sizeof(float));
  batch_.mutable_attributes()->append(reinterpret_cast<const char*>(tile.attributes.data()),
                                      tile.attributes.size() * sizeof(uint32_t));
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

void BrickBatcher::AddPacked(const TileBricks& tile) {
  if (packed_room_ - packed_bytes_ < kMaxPackedTileBytes) GrowPacked();
  packed_bytes_ = static_cast<size_t>(PackTile(tile, packed_.get() + packed_bytes_) - packed_.get());
}

// Grows to the room for one more tile, and for most tiles of a full batch.
void BrickBatcher::GrowPacked() {
  packed_room_ = std::max(2 * packed_bytes_, full_bytes_) + kMaxPackedTileBytes;
  auto grown = std::make_unique_for_overwrite<uint8_t[]>(packed_room_);
  if (packed_bytes_ != 0) std::memcpy(grown.get(), packed_.get(), packed_bytes_);
  packed_ = std::move(grown);
}

void BrickBatcher::StorePacked() {
  const std::string_view packed(reinterpret_cast<const char*>(packed_.get()), std::exchange(packed_bytes_, 0));
  std::optional<std::string> frame;
  if (encoding_ == BrickEncoding::kPackedZstd) frame = CompressWherePays(packed);
  if (frame) {
    batch_.set_packed(*std::move(frame));
    batch_.set_packed_bytes(static_cast<uint32_t>(packed.size()));
  } else {
    batch_.set_packed(packed.data(), packed.size());
  }
}

bool BrickBatcher::full() const {
  const size_t bytes = encoding_ == BrickEncoding::kMasks ? bricks_ * kBrickBytes : packed_bytes_;
  return bytes + batch_.values().size() + batch_.attributes().size() >= full_bytes_ ||
         bricks_ > kMaxBricks - kMaxTileBricks;
}

v1::BrickBatch BrickBatcher::Release() {
  if (packed_bytes_ != 0) StorePacked();
  batch_.set_progress(progress_);
  bricks_ = 0;
  full_bytes_ = std::min(2 * full_bytes_, kFullBytes);
  return std::exchange(batch_, {});
}

}  // namespace latvox
