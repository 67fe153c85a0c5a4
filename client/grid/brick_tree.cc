#include "client/grid/brick_tree.h"

#include <algorithm>

namespace latvox::client {

TreePlace PlaceOf(const Vec3i& brick_ijk) {
  TreePlace place;
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto n = static_cast<uint32_t>(brick_ijk[axis]);
    place.upper[axis] = static_cast<int32_t>((n & ~uint32_t{511}) * 8);
    place.lower = place.lower << 5 | (n >> 4 & 31);
    place.brick = place.brick << 4 | (n & 15);
  }
  return place;
}

Vec3i BrickAt(const TreePlace& place) {
  Vec3i brick;
  for (size_t axis = 0; axis < 3; ++axis) {
    const size_t lower_shift = 5 * (2 - axis), brick_shift = 4 * (2 - axis);
    brick[axis] = place.upper[axis] / 8 + static_cast<int32_t>((place.lower >> lower_shift & 31) * 16) +
                  static_cast<int32_t>(place.brick >> brick_shift & 15);
  }
  return brick;
}

void LowerNode::Add(uint32_t child, const BrickMask& mask) {
  if (tiles_.Has(child)) return;
  BrickMask all = mask;
  if (leaves_.Has(child)) {
    const auto old = std::ranges::find(masks_, child, &Leaf::number);
    for (size_t word = 0; word < all.size(); ++word) all[word] |= old->mask[word];
    *old = masks_.back();
    masks_.pop_back();
    leaves_.Clear(child);
  }
  if (all == kFullBrick) {
    tiles_.Set(child);
  } else {
    leaves_.Set(child);
    masks_.push_back({all, static_cast<uint16_t>(child)});
  }
}

void BrickTree::Add(std::span<const Brick> bricks) {
  for (const Brick& brick : bricks) {
    const TreePlace place = PlaceOf(brick.brick_ijk), first{place.upper, place.lower};
    if (last_ == nodes_.end() || last_->first != first) {
      last_ = nodes_.try_emplace(first).first;
      if (!last_->second) last_->second = std::make_shared<LowerNode>(place.upper, place.lower);
    }
    last_->second->Add(place.brick, brick.mask);
  }
}

}  // namespace latvox::client
