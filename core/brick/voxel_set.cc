#include "core/brick/voxel_set.h"

#include <utility>

#include "core/base/sort.h"

namespace latvox {
namespace {

struct Place {
  Vec3i brick_ijk;
  uint32_t bit;
};

Place PlaceOf(const Vec3i& ijk) {
  Place place{{}, 0};
  for (size_t m = 0; m < 3; ++m) {
    place.brick_ijk[m] = ijk[m] >> kBrickBits;
    place.bit = place.bit << kBrickBits | static_cast<uint32_t>(ijk[m] & (kBrickSide - 1));
  }
  return place;
}

}  // namespace

BrickMask& VoxelSet::MaskOf(const Vec3i& brick_ijk) {
  const auto [entry, added] = index_.try_emplace(brick_ijk, static_cast<uint32_t>(masks_.size()));
  if (added) masks_.push_back({});
  return masks_[entry->second];
}

void VoxelSet::Add(const Brick& brick) {
  BrickMask& mask = MaskOf(brick.brick_ijk);
  size_ -= CountVoxels(mask);
  for (size_t n = 0; n < mask.size(); ++n) mask[n] |= brick.mask[n];
  size_ += CountVoxels(mask);
}

void VoxelSet::Add(const VoxelSet& other, StopSignal stop) {
  for (const auto& [brick_ijk, index] : other.index_) {
    if (stop.Stopped()) return;
    Add({brick_ijk, other.masks_[index]});
  }
}

void VoxelSet::Insert(const Vec3i& ijk) {
  const Place place = PlaceOf(ijk);
  uint64_t& word = MaskOf(place.brick_ijk)[place.bit >> 6];
  const uint64_t bit = uint64_t{1} << (place.bit & 63);
  if ((word & bit) == 0) ++size_;
  word |= bit;
}

std::optional<uint64_t> VoxelSet::Find(const Vec3i& ijk) const {
  const Place place = PlaceOf(ijk);
  const auto entry = index_.find(place.brick_ijk);
  if (entry == index_.end() || !(masks_[entry->second][place.bit >> 6] >> (place.bit & 63) & 1)) return std::nullopt;
  return uint64_t{entry->second} << 9 | place.bit;
}

std::vector<Brick> VoxelSet::Bricks(StopSignal stop) const {
  std::vector<std::pair<Vec3i, uint32_t>> places(index_.begin(), index_.end());
  Sort(places, stop);
  std::vector<Brick> bricks;
  bricks.reserve(places.size());
  for (const auto& [brick_ijk, index] : places) {
    if (stop.Stopped()) break;
    bricks.push_back({brick_ijk, masks_[index]});
  }
  return bricks;
}

}  // namespace latvox
