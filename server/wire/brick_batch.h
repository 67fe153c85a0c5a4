// Collects tiles in BrickBatch messages.
#ifndef LATVOX_SERVER_WIRE_BRICK_BATCH_H_
#define LATVOX_SERVER_WIRE_BRICK_BATCH_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/brick/brick.h"
#include "latvox/v1/voxelizer.pb.h"

namespace latvox {

// The encoding of bricks on the wire: v1::BrickEncoding, without its default.
enum class BrickEncoding { kMasks, kPacked, kPackedZstd };

// Puts whole tiles, in the order of their arrival, into messages of the size that gRPC moves fastest: 256 KiB to 1 MiB.
class BrickBatcher {
 public:
  // A batch is full at this size, before zstd. The first batches of a stream are full at an eighth, a quarter and a
  // half of it, so that the client can start early. One more tile has at most 512 * 76 bytes, and each part of it at
  // most kMostPartBytes of fields. So messages stay below 1 MiB, and with fields below 4 MiB.
  static constexpr size_t kFullBytes = size_t{512} << 10;
  static constexpr size_t kFirstFullBytes = kFullBytes / 8;
  // The contract's limit. Bricks that pack well reach it before kFullBytes.
  static constexpr size_t kMaxBricks = 32768;
  // The bytes of all fields of a part of a tile.
  static constexpr size_t kMostPartBytes = size_t{3} << 20;

  explicit BrickBatcher(BrickEncoding encoding) : encoding_(encoding) {}

  // Divides a tile into parts with at most kMostPartBytes of fields, in order. Mostly that is the tile itself.
  static std::vector<TileBricks> PartsOf(TileBricks tile);

  // Adds a tile, or a part of one.
  void Add(const TileBricks& part);

  bool empty() const { return bricks_ == 0; }
  bool full() const;

  // Returns the batch so far, and begins an empty one. Its progress is that of the last tile, and never decreases.
  //   tile_continues   whether it ends with a part of a tile, which is not the last one
  v1::BrickBatch Release(bool tile_continues = false);

 private:
  void AddFields(const TileBricks& tile);
  void StoreFields();
  void AddMasks(const TileBricks& tile);
  void AddPacked(const TileBricks& tile);
  void GrowPacked();
  void StorePacked();

  const BrickEncoding encoding_;
  v1::BrickBatch batch_;
  std::unique_ptr<uint8_t[]> packed_;  // kept from batch to batch
  size_t packed_room_ = 0, packed_bytes_ = 0;
  size_t bricks_ = 0;       // in batch_ or packed_
  size_t voxels_ = 0;       // of these
  size_t field_bytes_ = 0;  // in batch_
  size_t full_bytes_ = kFirstFullBytes;
  double progress_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_WIRE_BRICK_BATCH_H_
