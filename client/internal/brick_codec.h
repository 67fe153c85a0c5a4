// Decodes BrickBatch.packed to bricks. proto/latvox/v1/voxelizer.proto states the format. Internal to the SDK.
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
inline constexpr size_t kMaxFieldBytes = 3670016;  // of all fields together

// Ways to scatter the bytes of an octree. All give the same bricks.
enum class UnpackKernel { kPortable, kSsse3 };

// Returns the fastest kernel for this processor.
UnpackKernel BestUnpackKernel();

// Decodes `packed`, which may be anything, and replaces the content of `bricks`; after an error, that is meaningless.
// Bricks come in their written order: sorted within a tile, and none is empty. It does not check whether a tile comes
// twice, or where it lies. Memory: kMaxBatchBricks at most. Errors: INVALID_ARGUMENT naming the fault, and the byte.
absl::Status UnpackBricks(std::string_view packed, std::vector<Brick>& bricks,
                          UnpackKernel kernel = BestUnpackKernel());

// Decompresses one zstd frame, which may be anything, to `plain` with `plain_bytes` bytes, at most `most`. Memory:
// plain_bytes and zstd's fixed tables. Errors: INVALID_ARGUMENT naming the fault.
absl::Status Decompress(std::string_view frame, size_t plain_bytes, size_t most, std::string& plain);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_BRICK_CODEC_H_
