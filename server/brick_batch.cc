#include "server/brick_batch.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace latvox {
namespace {

constexpr size_t kMaskBytes = sizeof(BrickMask);
constexpr size_t kBrickBytes = kMaskBytes + sizeof(Vec3i);

static_assert(kMaskBytes == 64);
static_assert(std::endian::native == std::endian::little, "masks are sent as they lie in memory");

}  // namespace

void BrickBatcher::Add(const TileBricks& tile) {
  std::string& masks = *batch_.mutable_masks();
  if (masks.empty()) {
    masks.reserve(kFullBytes);
    batch_.mutable_brick_ijk()->Reserve(static_cast<int>(3 * kFullBytes / kBrickBytes));
  }
  for (const Brick& brick : tile.bricks) {
    for (int32_t coordinate : brick.brick_ijk) batch_.add_brick_ijk(coordinate);
    masks.append(reinterpret_cast<const char*>(brick.mask.data()), kMaskBytes);
  }
  progress_ = std::clamp(tile.progress, progress_, 1.0);
}

bool BrickBatcher::full() const { return batch_.masks().size() / kMaskBytes * kBrickBytes >= kFullBytes; }

v1::BrickBatch BrickBatcher::Take() {
  batch_.set_progress(progress_);
  return std::exchange(batch_, {});
}

}  // namespace latvox
