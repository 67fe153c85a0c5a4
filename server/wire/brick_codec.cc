#include "server/wire/brick_codec.h"

// ZSTD_c_literalCompressionMode is a number for a public function.
#define ZSTD_STATIC_LINKING_ONLY
#include <zstd.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#if defined(__x86_64__)
#include <tmmintrin.h>
#define LATVOX_SSSE3 __attribute__((target("ssse3")))
#endif

namespace latvox {
namespace {

static_assert(std::endian::native == std::endian::little, "words are read as bytes, and sent as they lie in memory");

// Two words of a mask, in one register of any processor with vectors.
using Words [[gnu::vector_size(16)]] = uint64_t;

// Exchanges the bits `bits << shift` of a with the bits `bits` of b.
inline void Exchange(Words& a, Words& b, int shift, uint64_t bits) {
  const Words difference = ((a >> shift) ^ b) & bits;
  b ^= difference;
  a ^= difference << shift;
}

// A mask's leaves: byte (o, s) holds the cells of octant s of octant o, in the order of the format.
//
// The cell (x, y, z), each of three bits x2 x1 x0, is in word x2 x1 x0 of a mask, bit y2 y1 y0 z2 z1 z0. The format has
// it in word x2 y2 z2, bit x1 y1 z1 x0 y0 z0. Three exchanges do this: x1 with y2, x0 with z2 (between words), z1 with
// y0.
inline BrickMask LeavesOf(const BrickMask& mask) {
  Words w01, w23, w45, w67;
  std::memcpy(&w01, &mask[0], sizeof(Words));
  std::memcpy(&w23, &mask[2], sizeof(Words));
  std::memcpy(&w45, &mask[4], sizeof(Words));
  std::memcpy(&w67, &mask[6], sizeof(Words));
  Exchange(w01, w23, 32, 0x00000000FFFFFFFF);
  Exchange(w45, w67, 32, 0x00000000FFFFFFFF);
  Words even[2] = {__builtin_shufflevector(w01, w23, 0, 2), __builtin_shufflevector(w45, w67, 0, 2)};
  Words odd[2] = {__builtin_shufflevector(w01, w23, 1, 3), __builtin_shufflevector(w45, w67, 1, 3)};
  BrickMask leaves;
  for (size_t half = 0; half < 2; ++half) {
    Exchange(even[half], odd[half], 4, 0x0F0F0F0F0F0F0F0F);
    for (Words* words : {&even[half], &odd[half]}) {
      const Words difference = ((*words >> 6) ^ *words) & 0x00CC00CC00CC00CC;
      *words ^= difference ^ difference << 6;
    }
    const Words low = __builtin_shufflevector(even[half], odd[half], 0, 2);
    const Words high = __builtin_shufflevector(even[half], odd[half], 1, 3);
    std::memcpy(&leaves[4 * half], &low, sizeof(low));
    std::memcpy(&leaves[4 * half + 2], &high, sizeof(high));
  }
  return leaves;
}

// Bit n of the result: byte n of the word is not 0.
inline uint64_t NonZeroBytes(uint64_t word) {
  constexpr uint64_t kLow7 = 0x7F7F7F7F7F7F7F7F;
  const uint64_t ones = ((((word & kLow7) + kLow7) | word) & ~kLow7) >> 7;  // 1 in each byte that is not 0
  return (ones * 0x0102040810204080) >> 56;
}

// Almost never true in a surface, almost always in a solid, so the branch is predicted well.
inline bool IsFull(const BrickMask& mask) {
  return std::all_of(mask.begin(), mask.end(), [](uint64_t word) { return word == ~uint64_t{0}; });
}

// Writes the octree of a full brick.
inline uint8_t* PackFull(uint8_t* out) {
  *out++ = 0;
  return out;
}

// Writes the bytes of `word` that `which` names, the lowest first.
inline uint8_t* Gather(uint64_t word, uint64_t which, uint8_t* out) {
  for (; which != 0; which &= which - 1) *out++ = static_cast<uint8_t>(word >> (8 * std::countr_zero(which)));
  return out;
}

// Writes the octree of a mask that is not empty; returns the end of its bytes. Needs room for kMaxOctreeBytes.
uint8_t* PackPortably(const BrickMask& mask, uint8_t* out) {
  if (IsFull(mask)) return PackFull(out);
  const BrickMask leaves = LeavesOf(mask);
  uint64_t nodes = 0;  // of the middle level: byte o, bit s
  for (int o = 0; o < 8; ++o) nodes |= NonZeroBytes(leaves[o]) << 8 * o;
  const uint64_t root = NonZeroBytes(nodes);
  *out++ = static_cast<uint8_t>(root);
  out = Gather(nodes, root, out);
  for (int o = 0; o < 8; ++o) out = Gather(leaves[o], nodes >> 8 * o & 0xFF, out);
  return out;
}

#if defined(__x86_64__)

// For each set of bytes of a word: the shuffle that moves these bytes to the front, in order.
struct GatherTable {
  uint64_t shuffles[256] = {};
  constexpr GatherTable() {
    for (uint64_t which = 0; which < 256; ++which) {
      int count = 0;
      for (uint64_t n = 0; n < 8; ++n) {
        if (which >> n & 1) shuffles[which] |= n << 8 * count++;
      }
    }
  }
};
constexpr GatherTable kGather;

// Byte n of the result: the number of bits set in byte n of the word.
inline uint64_t CountInBytes(uint64_t word) {
  word -= word >> 1 & 0x5555555555555555;
  word = (word & 0x3333333333333333) + (word >> 2 & 0x3333333333333333);
  return (word + (word >> 4)) & 0x0F0F0F0F0F0F0F0F;
}

// Like Gather, but always writes eight bytes; only the first ones count.
LATVOX_SSSE3 inline void GatherFast(uint64_t word, uint64_t which, uint8_t* out) {
  const __m128i shuffle = _mm_cvtsi64_si128(static_cast<int64_t>(kGather.shuffles[which]));
  const __m128i bytes = _mm_shuffle_epi8(_mm_cvtsi64_si128(static_cast<int64_t>(word)), shuffle);
  _mm_storel_epi64(reinterpret_cast<__m128i*>(out), bytes);
}

// Like PackPortably. No other branch depends on the mask: in a surface's bricks, none could be predicted.
LATVOX_SSSE3 inline uint8_t* PackFast(const BrickMask& mask, uint8_t* out) {
  if (IsFull(mask)) return PackFull(out);
  const BrickMask leaves = LeavesOf(mask);
  uint64_t nodes = 0;
  for (int pair = 0; pair < 4; ++pair) {
    const __m128i words = _mm_loadu_si128(reinterpret_cast<const __m128i*>(leaves.data()) + pair);
    const int zero = _mm_movemask_epi8(_mm_cmpeq_epi8(words, _mm_setzero_si128()));
    nodes |= (~static_cast<uint64_t>(zero) & 0xFFFF) << 16 * pair;
  }
  const uint64_t root = NonZeroBytes(nodes);
  *out++ = static_cast<uint8_t>(root);
  GatherFast(nodes, root, out);
  out += CountInBytes(root);
  const uint64_t ends =
      CountInBytes(nodes) * 0x0101010101010101;  // byte o: the number of leaves in words 0..o, at most 64
  for (int o = 0; o < 8; ++o) GatherFast(leaves[o], nodes >> 8 * o & 0xFF, out + ((ends << 8) >> 8 * o & 0xFF));
  return out + (ends >> 56);
}

LATVOX_SSSE3 uint8_t* PackAllFast(const BrickMask& which, const std::vector<Brick>& bricks, uint8_t* out) {
  out = PackFast(which, out);
  for (const Brick& brick : bricks) out = PackFast(brick.mask, out);
  return out;
}

#endif

uint8_t* PackAllPortably(const BrickMask& which, const std::vector<Brick>& bricks, uint8_t* out) {
  out = PackPortably(which, out);
  for (const Brick& brick : bricks) out = PackPortably(brick.mask, out);
  return out;
}

using ZstdContext = std::unique_ptr<ZSTD_CCtx, size_t (*)(ZSTD_CCtx*)>;

// Octrees hardly repeat themselves, and zstd spends its time on the search for repetitions. This is the level with the
// least search, but with the Huffman code for literals, which levels below 1 leave out. It takes a third of the time of
// level 1, and saves three quarters as much.
ZstdContext NewZstdContext() {
  ZstdContext context(ZSTD_createCCtx(), &ZSTD_freeCCtx);
  if (context == nullptr) return context;
  for (const auto& [parameter, value] : {std::pair{ZSTD_c_compressionLevel, ZSTD_minCLevel()},
                                         std::pair{ZSTD_c_literalCompressionMode, int{ZSTD_lcm_huffman}}}) {
    [[maybe_unused]] const size_t error = ZSTD_CCtx_setParameter(context.get(), parameter, value);
    assert(!ZSTD_isError(error));
  }
  return context;
}

}  // namespace

PackKernel BestPackKernel() {
#if defined(__x86_64__)
  static const bool ssse3 = __builtin_cpu_supports("ssse3");
  if (ssse3) return PackKernel::kSsse3;
#endif
  return PackKernel::kPortable;
}

uint8_t* PackTile(const TileBricks& tile, uint8_t* out, [[maybe_unused]] PackKernel kernel) {
  std::memcpy(out, &tile.tile_ijk, sizeof(tile.tile_ijk));
  out += sizeof(tile.tile_ijk);
  BrickMask which = {};
  for (const Brick& brick : tile.bricks) {
    const auto& [i, j, k] = brick.brick_ijk;
    which[i & 7] |= uint64_t{1} << ((j & 7) << 3 | (k & 7));
  }
#if defined(__x86_64__)
  if (kernel == PackKernel::kSsse3) return PackAllFast(which, tile.bricks, out);
#endif
  assert(kernel == PackKernel::kPortable);
  return PackAllPortably(which, tile.bricks, out);
}

std::optional<std::string> CompressWherePays(std::string_view packed) {
  // The arena's threads keep it, instead of jobs, because it has several hundred kilobytes.
  thread_local const ZstdContext context = NewZstdContext();
  if (context == nullptr) return std::nullopt;  // no memory: the batch is sent without compression
  std::string frame(packed.size() - packed.size() / 8, '\0');
  const size_t size = ZSTD_compress2(context.get(), frame.data(), frame.size(), packed.data(), packed.size());
  if (ZSTD_isError(size)) return std::nullopt;  // the frame does not fit
  frame.resize(size);
  return frame;
}

}  // namespace latvox
