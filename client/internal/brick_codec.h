// BrickBatch.packed -> bricks. The format stands in proto/latvox/v1/voxelizer.proto. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_BRICK_CODEC_H_
#define LATVOX_CLIENT_INTERNAL_BRICK_CODEC_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "latvox/types.h"

namespace latvox::client {

// The protocol's limits of one batch.
inline constexpr size_t kMaxPackedBytes = size_t{1} << 20;
inline constexpr size_t kMaxBatchBricks = 32768;

// How to scatter the bytes of an octree. All give the same bricks.
enum class UnpackKernel { kPortable, kSsse3 };

// The fastest that this processor has.
UnpackKernel BestUnpackKernel();

// Decodes `packed`, which may be anything. What stood in `bricks` before is gone; after an error its content has no
// meaning. Bricks come as they are written: in order within a tile, none of them empty; whether a tile comes twice, and
// where it lies, is not looked at. Memory: kMaxBatchBricks at most.
// Errors: INVALID_ARGUMENT naming what is wrong, and the byte.
absl::Status UnpackBricks(std::string_view packed, std::vector<Brick>& bricks,
                          UnpackKernel kernel = BestUnpackKernel());

// Bits of the mask.
size_t CountVoxels(const Brick& brick);

// Takes `packed` of `packed_bytes` bytes out of one zstd frame, which may be anything. Memory: packed_bytes and zstd's
// fixed tables.
// Errors: INVALID_ARGUMENT naming what is wrong.
absl::Status Decompress(std::string_view frame, size_t packed_bytes, std::string& packed);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_BRICK_CODEC_H_
