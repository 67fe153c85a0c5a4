// Encodes bricks as BrickBatch.packed. proto/latvox/v1/voxelizer.proto states the format.
#ifndef LATVOX_SERVER_WIRE_BRICK_CODEC_H_
#define LATVOX_SERVER_WIRE_BRICK_CODEC_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/brick/brick.h"

namespace latvox {

// Ways to find and gather the bytes of an octree. All give the same bytes.
enum class PackKernel { kPortable, kSsse3 };

// Returns the fastest kernel for this processor.
PackKernel BestPackKernel();

// The most bytes of an octree of 512 cells: all nodes.
inline constexpr size_t kMaxOctreeBytes = 1 + 8 + 64;
// The most bytes of a tile: its position, its bricks' octree, and all bricks.
inline constexpr size_t kMaxPackedTileBytes = 3 * sizeof(int32_t) + (1 + 512) * kMaxOctreeBytes;

// Writes one tile; returns the end of its bytes. Preconditions: the tile's bricks lie in it, in order, and none is
// empty. `out` has room for kMaxPackedTileBytes, and all of that may be overwritten.
uint8_t* PackTile(const TileBricks& tile, uint8_t* out, PackKernel kernel = BestPackKernel());

// Returns `packed` as one zstd frame, if that saves at least an eighth.
std::optional<std::string> CompressWherePays(std::string_view packed);

}  // namespace latvox

#endif  // LATVOX_SERVER_WIRE_BRICK_CODEC_H_
