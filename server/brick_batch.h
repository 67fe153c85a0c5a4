// Tiles -> BrickBatch messages.
#ifndef LATVOX_SERVER_BRICK_BATCH_H_
#define LATVOX_SERVER_BRICK_BATCH_H_

#include <cstddef>

#include "core/tile/brick.h"
#include "latvox/v1/voxelizer.pb.h"

namespace latvox {

// Packs whole tiles, in the order they come, into messages of the size that gRPC moves fastest: 256 KiB to 1 MiB.
class BrickBatcher {
 public:
  // A batch is full at this size. One more tile is at most 512 * 76 bytes, so that messages stay below 1 MiB.
  static constexpr size_t kFullBytes = size_t{512} << 10;

  void Add(const TileBricks& tile);

  bool empty() const { return batch_.brick_ijk().empty(); }
  bool full() const;

  // The batch so far; the next one begins empty. Its progress is that of the last tile, and never decreases.
  v1::BrickBatch Take();

 private:
  v1::BrickBatch batch_;
  double progress_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_BRICK_BATCH_H_
