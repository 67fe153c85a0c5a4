#include "server/wire/brick_batch.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/request/fields.h"
#include "server/wire/brick_codec.h"

namespace latvox {
namespace {

constexpr size_t kMaskBytes = sizeof(BrickMask);
constexpr size_t kBrickBytes = kMaskBytes + sizeof(Vec3i);
constexpr size_t kMaxTileBricks = 512;

static_assert(kMaskBytes == 64);
static_assert(BrickBatcher::kFullBytes + std::max(kMaxTileBricks * kBrickBytes, kMaxPackedTileBytes) < 1 << 20);
static_assert(BrickBatcher::kFullBytes + BrickBatcher::kMostPartBytes <= 3670016, "the contract's limit of fields");
static_assert(512 * kMostBytesOfVoxel <= BrickBatcher::kMostPartBytes, "a brick fits in a part");
static_assert(std::endian::native == std::endian::little, "masks and values are sent as they lie in memory");

// The n-th bytes of all voxels stand together, for each n in turn.
std::string InPlanes(std::string_view values, size_t bytes_of_voxel) {
  const size_t voxels = values.size() / bytes_of_voxel;
  std::string planes(values.size(), '\0');
  for (size_t n = 0; n < bytes_of_voxel; ++n) {
    for (size_t voxel = 0; voxel < voxels; ++voxel) planes[n * voxels + voxel] = values[voxel * bytes_of_voxel + n];
  }
  return planes;
}

// The bricks from `first` to `end` - 1, which have `voxels` voxels after `voxels_before`.
TileBricks PartOf(const TileBricks& tile, size_t first, size_t end, uint64_t voxels_before, uint64_t voxels) {
  const auto at = [](auto& list, uint64_t n) { return list.begin() + static_cast<std::ptrdiff_t>(n); };
  TileBricks part{tile.tile_ijk, {at(tile.bricks, first), at(tile.bricks, end)}, voxels, tile.progress};
  for (const std::vector<std::byte>& field : tile.fields) {
    const size_t bytes = field.size() / tile.voxels;
    part.fields.emplace_back(at(field, voxels_before * bytes), at(field, (voxels_before + voxels) * bytes));
  }
  return part;
}

}  // namespace

std::vector<TileBricks> BrickBatcher::PartsOf(TileBricks tile) {
  std::vector<TileBricks> parts;
  size_t bytes_of_voxel = 0;
  for (const std::vector<std::byte>& field : tile.fields) bytes_of_voxel += field.size() / tile.voxels;
  if (tile.voxels * bytes_of_voxel <= kMostPartBytes) {
    parts.push_back(std::move(tile));
    return parts;
  }
  size_t first = 0;
  uint64_t voxels_before = 0, voxels = 0;
  for (size_t n = 0; n <= tile.bricks.size(); ++n) {
    const uint64_t more = n < tile.bricks.size() ? CountVoxels(tile.bricks[n].mask) : 0;
    if (n == tile.bricks.size() || (voxels + more) * bytes_of_voxel > kMostPartBytes) {
      parts.push_back(PartOf(tile, first, n, voxels_before, voxels));
      first = n;
      voxels_before += voxels;
      voxels = 0;
    }
    voxels += more;
  }
  return parts;
}

void BrickBatcher::Add(const TileBricks& tile) {
  encoding_ == BrickEncoding::kMasks ? AddMasks(tile) : AddPacked(tile);
  AddFields(tile);
  bricks_ += tile.bricks.size();
  voxels_ += tile.voxels;
  progress_ = std::clamp(tile.progress, progress_, 1.0);
}

void BrickBatcher::AddFields(const TileBricks& tile) {
  while (static_cast<size_t>(batch_.fields_size()) < tile.fields.size()) batch_.add_fields();
  for (size_t n = 0; n < tile.fields.size(); ++n) {
    const std::vector<std::byte>& field = tile.fields[n];
    batch_.mutable_fields(static_cast<int>(n))
        ->mutable_values()
        ->append(reinterpret_cast<const char*>(field.data()), field.size());
    field_bytes_ += field.size();
  }
}

void BrickBatcher::StoreFields() {
  if (encoding_ != BrickEncoding::kPackedZstd) return;
  for (int n = 0; n < batch_.fields_size(); ++n) {
    v1::FieldValues& field = *batch_.mutable_fields(n);
    std::optional<std::string> frame = CompressWherePays(InPlanes(field.values(), field.values().size() / voxels_));
    if (!frame) continue;
    field.set_plain_bytes(static_cast<uint32_t>(field.values().size()));
    field.set_values(*std::move(frame));
  }
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
  return bytes + field_bytes_ >= full_bytes_ || bricks_ > kMaxBricks - kMaxTileBricks;
}

v1::BrickBatch BrickBatcher::Release(bool tile_continues) {
  if (packed_bytes_ != 0) StorePacked();
  StoreFields();
  batch_.set_tile_continues(tile_continues);
  batch_.set_progress(progress_);
  bricks_ = voxels_ = field_bytes_ = 0;
  full_bytes_ = std::min(2 * full_bytes_, kFullBytes);
  return std::exchange(batch_, {});
}

}  // namespace latvox
