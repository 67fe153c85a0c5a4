#include "core/walk/joint_cubes.h"

#include <cassert>

namespace latvox {

uint64_t JointCubes::KeyOf(const Vec3i& tile_ijk, int level) const {
  constexpr int kBits = 16;  // a mesh extends over less than 2^12 tiles
  auto key = static_cast<uint64_t>(level);
  for (size_t m = 0; m < 3; ++m) {
    const int32_t cube = (tile_ijk[m] - first_tile_[m]) >> level;
    assert(cube >= 0 && cube < 1 << kBits);
    key = key << kBits | static_cast<uint64_t>(cube);
  }
  return key;
}

void JointCubes::Add(uint32_t rank, const Vec3i& tile_ijk, int level) {
  level = std::max(level, kLeastLevel);
  Chain& chain = chains_[KeyOf(tile_ijk, level)];
  const bool is_new = chain.first == kNone;
  if (!is_new && links_[chain.last].rank == rank) return;
  const auto added = static_cast<uint32_t>(links_.size());
  (is_new ? chain.first : links_[chain.last].next) = added;
  chain.last = added;
  links_.push_back({rank, kNone});
  while (is_new && level < level_ && chains_.try_emplace(KeyOf(tile_ijk, ++level)).second) {
  }
}

bool JointCubes::MayHold(const Vec3i& tile_ijk, int level) const {
  assert(level >= kLeastLevel);
  for (int at = level_; at > level; --at) {
    const auto found = chains_.find(KeyOf(tile_ijk, at));
    if (found == chains_.end()) return false;
    if (found->second.first != kNone) return true;  // a walk holds all of this cube
  }
  return chains_.contains(KeyOf(tile_ijk, level));
}

}  // namespace latvox
