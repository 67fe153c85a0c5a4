#include "client/internal/brick_codec.h"

#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>

#include "absl/strings/str_cat.h"
#include "latvox/for_each_voxel.h"

#if defined(__x86_64__)
#include <tmmintrin.h>
#define LATVOX_SSSE3 __attribute__((target("ssse3")))
#endif

namespace latvox::client {
namespace {

using Mask = decltype(Brick::mask);

// The root, eight nodes, 64 leaves; or one byte for all cells.
constexpr size_t kMinOctreeBytes = 1, kMaxOctreeBytes = 1 + 8 + 64;
constexpr size_t kTileIjkBytes = sizeof(Vec3i);
// The range of lattice coordinates in 32 bits, shifted right by 6.
constexpr int32_t kMinTile = -(1 << 25), kMaxTile = (1 << 25) - 1;

static_assert(std::endian::native == std::endian::little, "words are written as bytes, and lie in memory as received");

// Two words of a mask, in one register of any processor with vectors.
using Words [[gnu::vector_size(16)]] = uint64_t;

// Exchanges the bits `bits << shift` of a with the bits `bits` of b.
inline void Exchange(Words& a, Words& b, int shift, uint64_t bits) {
  const Words difference = ((a >> shift) ^ b) & bits;
  b ^= difference;
  a ^= difference << shift;
}

// Returns the mask with these leaves: byte (o, s) of them holds the cells of octant s of octant o.
//
// The cell (x, y, z), each of three bits x2 x1 x0, comes in word x2 y2 z2, bit x1 y1 z1 x0 y0 z0. It belongs in word x2
// x1 x0, bit y2 y1 y0 z2 z1 z0. Three exchanges do this: z1 with y0, x0 with z2 (between words), x1 with y2.
inline Mask MaskOf(const Mask& leaves) {
  Words words[2][2];  // [o >> 2]: those with x0 = 0, those with 1; in both x1 = 0, 1
  for (size_t half = 0; half < 2; ++half) {
    Words low, high;
    std::memcpy(&low, &leaves[4 * half], sizeof(low));
    std::memcpy(&high, &leaves[4 * half + 2], sizeof(high));
    for (Words* w : {&low, &high}) {
      const Words difference = ((*w >> 6) ^ *w) & 0x00CC00CC00CC00CC;
      *w ^= difference ^ difference << 6;
    }
    Words even = __builtin_shufflevector(low, high, 0, 2), odd = __builtin_shufflevector(low, high, 1, 3);
    Exchange(even, odd, 4, 0x0F0F0F0F0F0F0F0F);
    words[half][0] = __builtin_shufflevector(even, odd, 0, 2);
    words[half][1] = __builtin_shufflevector(even, odd, 1, 3);
    Exchange(words[half][0], words[half][1], 32, 0x00000000FFFFFFFF);
  }
  Mask mask;
  static_assert(sizeof(mask) == sizeof(words));
  std::memcpy(&mask, words, sizeof(mask));
  return mask;
}

// Byte n of the result: the number of bits set in byte n of the word.
inline uint64_t CountInBytes(uint64_t word) {
  word -= word >> 1 & 0x5555555555555555;
  word = (word & 0x3333333333333333) + (word >> 2 & 0x3333333333333333);
  return (word + (word >> 4)) & 0x0F0F0F0F0F0F0F0F;
}

// Reads a byte, not 0, for each set bit of `which`, and puts it at the bit's place, lowest first. False: a byte is
// missing.
inline bool Scatter(const uint8_t*& in, const uint8_t* end, uint64_t which, uint64_t& word) {
  word = 0;
  for (; which != 0; which &= which - 1) {
    if (in == end || *in == 0) return false;
    word |= uint64_t{*in++} << 8 * std::countr_zero(which);
  }
  return true;
}

// Reads the octree of a full brick.
inline bool UnpackFull(const uint8_t*& in, Mask& mask) {
  ++in;
  mask.fill(~uint64_t{0});
  return true;
}

// Reads one octree. False: it is not valid, and `in` is anywhere up to `end`.
bool UnpackPortably(const uint8_t*& in, const uint8_t* end, Mask& mask) {
  if (in == end) return false;
  if (*in == 0) return UnpackFull(in, mask);
  const uint64_t root = *in++;
  uint64_t nodes = 0;
  if (!Scatter(in, end, root, nodes)) return false;
  Mask leaves;
  for (int o = 0; o < 8; ++o) {
    if (!Scatter(in, end, nodes >> 8 * o & 0xFF, leaves[o])) return false;
  }
  mask = MaskOf(leaves);
  return true;
}

#if defined(__x86_64__)

// For each set of bytes of a word: the shuffle that moves the first bytes there, in order, and clears the others.
struct ScatterTable {
  uint64_t shuffles[256] = {};
  constexpr ScatterTable() {
    for (uint64_t which = 0; which < 256; ++which) {
      uint64_t count = 0;
      for (int n = 0; n < 8; ++n) shuffles[which] |= (which >> n & 1 ? count++ : 0x80) << 8 * n;
    }
  }
};
constexpr ScatterTable kScatter;

// Like Scatter, but always reads eight bytes, and leaves zeros for NonZeroBytes to find.
LATVOX_SSSE3 inline uint64_t ScatterFast(const uint8_t* in, uint64_t which) {
  const __m128i bytes = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(in));
  const __m128i shuffle = _mm_cvtsi64_si128(static_cast<int64_t>(kScatter.shuffles[which]));
  return static_cast<uint64_t>(_mm_cvtsi128_si64(_mm_shuffle_epi8(bytes, shuffle)));
}

// Bit n of the result: byte n of the two words is not 0.
LATVOX_SSSE3 inline uint64_t NonZeroBytes(uint64_t low, uint64_t high) {
  const __m128i words = _mm_set_epi64x(static_cast<int64_t>(high), static_cast<int64_t>(low));
  return ~static_cast<uint64_t>(_mm_movemask_epi8(_mm_cmpeq_epi8(words, _mm_setzero_si128()))) & 0xFFFF;
}

// Like UnpackPortably, for at least kMaxOctreeBytes up to the end. No branch depends on the octree except the first,
// which is predicted well for surfaces and solids, and the last.
LATVOX_SSSE3 inline bool UnpackFast(const uint8_t*& in, Mask& mask) {
  if (*in == 0) return UnpackFull(in, mask);
  const uint64_t root = *in++;
  const uint64_t nodes = ScatterFast(in, root);
  in += CountInBytes(root);
  const uint64_t ends =
      CountInBytes(nodes) * 0x0101010101010101;  // byte o: the number of leaves in words 0..o, at most 64
  Mask leaves;
  for (int o = 0; o < 8; ++o) leaves[o] = ScatterFast(in + ((ends << 8) >> 8 * o & 0xFF), nodes >> 8 * o & 0xFF);
  in += ends >> 56;
  uint64_t found = 0;
  for (int o = 0; o < 8; o += 2) found |= NonZeroBytes(leaves[o], leaves[o + 1]) << 8 * o;
  mask = MaskOf(leaves);
  return NonZeroBytes(nodes, 0) == root && found == nodes;
}

LATVOX_SSSE3 bool UnpackAllFast(const uint8_t*& in, const uint8_t* end, Brick* bricks, size_t count) {
  for (size_t n = 0; n < count; ++n) {
    const bool room = static_cast<size_t>(end - in) >= kMaxOctreeBytes;
    if (!(room ? UnpackFast(in, bricks[n].mask) : UnpackPortably(in, end, bricks[n].mask))) return false;
  }
  return true;
}

#endif

// Reads `count` octrees into the bricks' masks. False: one of them is not valid.
bool UnpackAll(const uint8_t*& in, const uint8_t* end, Brick* bricks, size_t count,
               [[maybe_unused]] UnpackKernel kernel) {
#if defined(__x86_64__)
  if (kernel == UnpackKernel::kSsse3) return UnpackAllFast(in, end, bricks, count);
#endif
  assert(kernel == UnpackKernel::kPortable);
  for (size_t n = 0; n < count; ++n) {
    if (!UnpackPortably(in, end, bricks[n].mask)) return false;
  }
  return true;
}

// Gives the bricks of a tile their coordinates.
void Place(const Vec3i& tile_ijk, const Mask& which, Brick* brick) {
  for (int32_t i = 0; i < 8; ++i) {
    for (uint64_t word = which[i]; word != 0; word &= word - 1, ++brick) {
      const int32_t jk = std::countr_zero(word);
      brick->brick_ijk = {tile_ijk[0] * 8 + i, tile_ijk[1] * 8 + (jk >> 3), tile_ijk[2] * 8 + (jk & 7)};
    }
  }
}

// Reads the position of a tile. `in` must have kTileIjkBytes.
absl::Status ReadTileIjk(const uint8_t*& in, Vec3i& tile_ijk) {
  std::memcpy(&tile_ijk, in, kTileIjkBytes);
  in += kTileIjkBytes;
  for (const int32_t coordinate : tile_ijk) {
    if (coordinate >= kMinTile && coordinate <= kMaxTile) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("tile coordinate ", coordinate, " is not within ", kMinTile, " to ", kMaxTile));
  }
  return absl::OkStatus();
}

// Reads one tile, and writes its bricks behind the first `count`, which becomes their number.
absl::Status UnpackTile(const uint8_t*& in, const uint8_t* end, std::vector<Brick>& bricks, size_t& count,
                        UnpackKernel kernel) {
  if (static_cast<size_t>(end - in) < kTileIjkBytes) return absl::InvalidArgumentError("half a tile");
  Vec3i tile_ijk;
  if (absl::Status status = ReadTileIjk(in, tile_ijk); !status.ok()) return status;
  Brick which;
  if (!UnpackAll(in, end, &which, 1, kernel)) return absl::InvalidArgumentError("no octree of a tile's bricks");
  const size_t begin = count, added = CountVoxels(which);
  count += added;
  if (count > kMaxBatchBricks) {
    return absl::InvalidArgumentError(absl::StrCat(count, " bricks exceed ", kMaxBatchBricks));
  }
  if (bricks.size() < count) bricks.resize(count);
  Place(tile_ijk, which.mask, &bricks[begin]);
  if (!UnpackAll(in, end, &bricks[begin], added, kernel)) return absl::InvalidArgumentError("no octree of a brick");
  return absl::OkStatus();
}

}  // namespace

size_t CountVoxels(const Brick& brick) {
  uint64_t bytes = 0;
  for (const uint64_t word : brick.mask) bytes += CountInBytes(word);  // at most 64 in each byte
  constexpr uint64_t kEvenBytes = 0x00FF00FF00FF00FF;
  return ((bytes & kEvenBytes) + (bytes >> 8 & kEvenBytes)) * 0x0001000100010001 >> 48;
}

UnpackKernel BestUnpackKernel() {
#if defined(__x86_64__)
  static const bool ssse3 = __builtin_cpu_supports("ssse3");
  if (ssse3) return UnpackKernel::kSsse3;
#endif
  return UnpackKernel::kPortable;
}

absl::Status UnpackBricks(std::string_view packed, std::vector<Brick>& bricks, UnpackKernel kernel) {
  if (packed.size() > kMaxPackedBytes) {
    return absl::InvalidArgumentError(absl::StrCat("packed has ", packed.size(), " bytes, over ", kMaxPackedBytes));
  }
  // It overwrites bricks of an earlier batch instead of making them anew, and no batch moves as it grows. Reserved and
  // unused memory costs nothing.
  bricks.reserve(std::min(packed.size() / kMinOctreeBytes, kMaxBatchBricks));
  size_t count = 0;
  const auto* const begin = reinterpret_cast<const uint8_t*>(packed.data());
  const uint8_t* const end = begin + packed.size();
  for (const uint8_t* in = begin; in != end;) {
    const auto tile = in - begin;
    if (absl::Status status = UnpackTile(in, end, bricks, count, kernel); !status.ok()) {
      return absl::InvalidArgumentError(
          absl::StrCat("packed, tile at byte ", tile, " of ", packed.size(), ": ", status.message()));
    }
  }
  bricks.resize(count);
  return absl::OkStatus();
}

absl::Status Decompress(std::string_view frame, size_t plain_bytes, size_t most, std::string& plain) {
  if (plain_bytes > most) return absl::InvalidArgumentError(absl::StrCat(plain_bytes, " bytes exceed ", most));
  plain.resize(plain_bytes);
  const size_t size = ZSTD_decompress(plain.data(), plain.size(), frame.data(), frame.size());
  if (ZSTD_isError(size)) return absl::InvalidArgumentError(absl::StrCat("zstd: ", ZSTD_getErrorName(size)));
  if (size != plain_bytes) {
    return absl::InvalidArgumentError(absl::StrCat("decompresses to ", size, " bytes, not ", plain_bytes));
  }
  return absl::OkStatus();
}

}  // namespace latvox::client
