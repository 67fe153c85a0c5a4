// Bricks -> BrickBatch.packed. The format stands in proto/latvox/v1/voxelizer.proto.
#ifndef LATVOX_SERVER_WIRE_BRICK_CODEC_H_
#define LATVOX_SERVER_WIRE_BRICK_CODEC_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/brick/brick.h"

namespace latvox {

// How to find and gather the bytes of an octree. All give the same bytes.
enum class PackKernel { kPortable, kSsse3 };

// The fastest that this processor has.
PackKernel BestPackKernel();

// The octree of 512 cells has at most so many bytes: all nodes.
inline constexpr size_t kMaxOctreeBytes = 1 + 8 + 64;
// A tile: where it is, which bricks it has, and all of them.
inline constexpr size_t kMaxPackedTileBytes = 3 * sizeof(int32_t) + (1 + 512) * kMaxOctreeBytes;

// Writes one tile and returns where it ends. Preconditions: its bricks lie in it, in order, none of them empty; at
// `out` there is room for kMaxPackedTileBytes, all of which may be overwritten.
uint8_t* PackTile(const TileBricks& tile, uint8_t* out, PackKernel kernel = BestPackKernel());

// `packed` as one zstd frame, if that saves an eighth of it or more.
std::optional<std::string> CompressWherePays(std::string_view packed);

}  // namespace latvox

#endif  // LATVOX_SERVER_WIRE_BRICK_CODEC_H_
