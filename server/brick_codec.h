// Bricks -> BrickBatch.packed. The format stands in proto/latvox/v1/voxelizer.proto.
#ifndef LATVOX_SERVER_BRICK_CODEC_H_
#define LATVOX_SERVER_BRICK_CODEC_H_

#include <cstddef>
#include <string>

#include "core/tile/brick.h"

namespace latvox {

// How to find and gather the bytes of an octree. All give the same bytes.
enum class PackKernel { kPortable, kSsse3 };

// The fastest that this processor has.
PackKernel BestPackKernel();

// The octree of 512 cells has at most so many bytes: all nodes.
inline constexpr size_t kMaxOctreeBytes = 1 + 8 + 64;
// A tile: where it is, which bricks it has, and all of them.
inline constexpr size_t kMaxPackedTileBytes = 3 * sizeof(int32_t) + (1 + 512) * kMaxOctreeBytes;

// Appends one tile. Precondition: its bricks lie in it, in order, none of them empty.
void PackTile(const TileBricks& tile, std::string& packed, PackKernel kernel = BestPackKernel());

// Puts `packed` in one zstd frame, if that saves an eighth of it or more; else leaves it as it is and returns false.
bool CompressWherePays(std::string& packed);

}  // namespace latvox

#endif  // LATVOX_SERVER_BRICK_CODEC_H_
