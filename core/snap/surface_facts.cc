// Closedness, as a polynomial identity. Give each position p an indeterminate X_p. Over GF(2),
//   sum of X_a * X_b over all edges ab of all triangles, a != b,
// keeps the edges that occur an odd number of times: it is the zero polynomial iff the mesh is closed. It is evaluated
// at a pseudo-random H_p, 64 bits of a hash of the position, taken as a polynomial in GF(2)[x]. A sum of degree 2 that
// is not zero vanishes for at most 2/2^64 of all choices (Schwartz-Zippel, in GF(2^64); sums are compared before
// reduction, which only distinguishes more). Two halves of a 128-bit hash, as if independent, make it 4/2^128.
//
// In characteristic 2,
//   ab + bc + ca = (a + b)(a + c) + a^2,
// and a sum of squares is the square of the sum: one product a triangle does. The edges of a triangle with two equal
// corners cancel, or do not count.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/snap/surface_facts.cc"
#define HWY_WANT_AVX3_DL  // for AES of whole vectors
#include "core/snap/surface_facts.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "core/snap/corner_list.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

// What does not depend on the instruction set, once.
#ifndef LATVOX_CORE_SNAP_SURFACE_FACTS_ONCE_
#define LATVOX_CORE_SNAP_SURFACE_FACTS_ONCE_

namespace latvox {
namespace {

using Hash = SurfaceSums::Hash;

// The product of two polynomials in GF(2)[x], low half first.
Hash Multiply(uint64_t a, uint64_t b) {
  Hash product{};
  for (int n = 0; n < 64; ++n) {
    const uint64_t bit = -(b >> n & 1);
    product[0] ^= a << n & bit;
    product[1] ^= a >> 1 >> (63 - n) & bit;
  }
  return product;
}

bool HasArea(const Vec3i& a, const Vec3i& b, const Vec3i& c) {
  using Wide = Vec<int64_t, 3>;
  static_assert(kNormalBits <= 63);
  const Vec3i u = b - a, v = c - a;
  return Cross(Wide{u[0], u[1], u[2]}, Wide{v[0], v[1], v[2]}) != Wide{};
}

Hash HashOf(const Vec3i& position) {
  const XXH128_hash_t hash = XXH3_128bits(position.data(), sizeof(position));
  return {hash.low64, hash.high64};
}

// Counts a triangle of the list if it has no area. Whether its edges count: no two of its corners are equal.
bool HasEdges(const CornerList& list, size_t place, SurfaceSums& sums) {
  const Vec3i a = list.Corner(0, place), b = list.Corner(1, place), c = list.Corner(2, place);
  if (HasArea(a, b, c)) return true;
  ++sums.degenerate;
  return a != b && b != c && c != a;
}

void AddPlain(const CornerList& list, SurfaceSums& sums) {
  for (size_t t = 0; t < list.size; ++t) {
    if (!HasEdges(list, t, sums)) continue;
    const Hash a = HashOf(list.Corner(0, t)), b = HashOf(list.Corner(1, t)), c = HashOf(list.Corner(2, t));
    for (size_t n = 0; n < 2; ++n) {
      const Hash product = Multiply(a[n] ^ b[n], a[n] ^ c[n]);
      for (size_t m = 0; m < 2; ++m) sums.products[n][m] ^= product[m];
      sums.corners[n] ^= a[n];
    }
  }
}

}  // namespace
}  // namespace latvox

#endif  // LATVOX_CORE_SNAP_SURFACE_FACTS_ONCE_

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR  // which has no vectors of two

void AddInLanes(const CornerList& list, SurfaceSums& sums) { AddPlain(list, sums); }

#else

namespace hn = hwy::HWY_NAMESPACE;

// Triangles at a time, each in 128 bits of a vector: as many blocks as one instruction of AES takes.
constexpr size_t kBlocks = HWY_TARGET == HWY_AVX3_DL ? 4 : 1;

using Positions = hn::FixedTag<int32_t, 4 * kBlocks>;
using Hashes = hn::FixedTag<uint64_t, 2 * kBlocks>;
using Bytes = hn::FixedTag<uint8_t, 16 * kBlocks>;

// The hash: rounds of AES, each one to one, of which four leave no structure that differences of inputs could show
// [Daemen and Rijmen, The Design of Rijndael, 9.5: 25 active S-boxes]. Cheaper here than to keep a hash per vertex.
HWY_INLINE hn::Vec<Hashes> HashesOf(hn::Vec<Positions> positions) {
  alignas(16) static constexpr uint64_t kKeys[4][2] = {{0x243F6A8885A308D3, 0x13198A2E03707344},
                                                       {0xA4093822299F31D0, 0x082EFA98EC4E6C89},
                                                       {0x452821E638D01377, 0xBE5466CF34E90C6C},
                                                       {0xC0AC29B7C97C50DD, 0x3F84D5B5B5470917}};  // of pi
  auto block = hn::BitCast(Bytes(), positions);
  for (const auto& key : kKeys) block = hn::AESRound(block, hn::BitCast(Bytes(), hn::LoadDup128(Hashes(), key)));
  return hn::BitCast(Hashes(), block);
}

constexpr uint64_t kFirstLanes = 0x1111'1111'1111'1111;  // of 128 bits each

// Which 128 bits of the vector are zero: bits of their first lanes.
HWY_INLINE uint64_t ZeroBlocks(hn::Vec<Positions> v) {
  const Positions d;
  uint64_t lanes = 0;
  hn::StoreMaskBits(d, hn::Eq(v, hn::Zero(d)), reinterpret_cast<uint8_t*>(&lanes));
  lanes &= lanes >> 1;
  return lanes & lanes >> 2 & kFirstLanes;
}

void AddInLanes(const CornerList& list, SurfaceSums& sums) {
  const Positions d;
  const Hashes dh;
  alignas(16) static constexpr int32_t kAxes[] = {-1, -1, -1, 0};
  alignas(16) static constexpr uint8_t kRotation[] = {4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 12, 13, 14, 15};
  const auto axes = hn::LoadDup128(d, kAxes), rotation = hn::BitCast(d, hn::LoadDup128(Bytes(), kRotation));
  const auto rotated = [&](auto v) HWY_ATTR { return hn::TableLookupBytes(v, rotation); };
  auto first = hn::Zero(dh), second = first, corners = first;
  for (size_t t = 0; t < list.size; t += kBlocks) {
    const auto load = [&](size_t n) HWY_ATTR { return hn::And(hn::LoadU(d, list.corners[n][t].data()), axes); };
    const auto a = load(0), b = load(1), c = load(2);
    auto h = HashesOf(a), x = hn::Xor(h, HashesOf(b));
    const auto y = hn::Xor(h, HashesOf(c));
    // The axes of (b - a) x (c - a) modulo 2^32, rotated.
    const auto u = hn::Sub(b, a), v = hn::Sub(c, a);
    const auto normal = hn::Sub(hn::Mul(u, rotated(v)), hn::Mul(rotated(u), v));
    const uint64_t flat = ZeroBlocks(normal);
    const size_t here = std::min(kBlocks, list.size - t);
    if (flat != 0 || here < kBlocks) {
      uint64_t counts = 0;  // triangles whose edges count
      // If so, products are below 2^30, and the normal is exact.
      const auto fits = hn::Lt(hn::Max(hn::Abs(u), hn::Abs(v)), hn::Set(d, 1 << 15));
      if (here == kBlocks && hn::AllTrue(d, fits)) {
        sums.degenerate += static_cast<uint64_t>(std::popcount(flat));
        counts = ~(ZeroBlocks(u) | ZeroBlocks(v) | ZeroBlocks(hn::Sub(u, v)));
      } else {
        for (size_t n = 0; n < here; ++n) counts |= uint64_t{HasEdges(list, t + n, sums)} << 4 * n;
      }
      const uint64_t lanes = (counts & kFirstLanes) * 0xF;
      const auto kept = hn::LoadMaskBits(d, reinterpret_cast<const uint8_t*>(&lanes));
      const auto keep = [&](auto& hashes)
                            HWY_ATTR { hashes = hn::BitCast(dh, hn::IfThenElseZero(kept, hn::BitCast(d, hashes))); };
      keep(h);
      keep(x);
    }
    first = hn::Xor(first, hn::CLMulLower(x, y));
    second = hn::Xor(second, hn::CLMulUpper(x, y));
    corners = hn::Xor(corners, h);
  }
  const auto add = [&](auto blocks, Hash& sum) HWY_ATTR {
    Hash hashes[kBlocks];
    hn::StoreU(blocks, dh, hashes->data());
    for (const Hash& hash : hashes) sum = {sum[0] ^ hash[0], sum[1] ^ hash[1]};
  };
  add(first, sums.products[0]);
  add(second, sums.products[1]);
  add(corners, sums.corners);
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include "core/base/simd.h"

namespace latvox {

HWY_EXPORT(AddInLanes);

void SurfaceSums::Add(const CornerList& triangles) {
  SimdIsScalar() ? AddPlain(triangles, *this) : HWY_DYNAMIC_DISPATCH(AddInLanes)(triangles, *this);
}

void SurfaceSums::Add(const SurfaceSums& other) {
  degenerate += other.degenerate;
  for (size_t n = 0; n < 2; ++n) {
    for (size_t m = 0; m < 2; ++m) products[n][m] ^= other.products[n][m];
    corners[n] ^= other.corners[n];
  }
}

SurfaceFacts SurfaceSums::Facts() const {
  bool closed = true;
  for (size_t n = 0; n < 2; ++n) closed &= products[n] == Multiply(corners[n], corners[n]);
  return {degenerate, closed};
}

SurfaceFacts FactsOf(const SnappedMesh& mesh, const std::atomic<bool>& cancelled) {
  constexpr size_t kGrain = 4096;  // triangles a task
  using Part = oneapi::tbb::blocked_range<size_t>;
  const SurfaceSums sums = oneapi::tbb::parallel_reduce(
      Part(0, mesh.triangles.size(), kGrain), SurfaceSums{},
      [&](const Part& part, SurfaceSums s) {
        CornerList list;
        if (!cancelled) ForEachList(mesh, part.begin(), part.end(), list, [&] { s.Add(list); });
        return s;
      },
      [](SurfaceSums a, const SurfaceSums& b) {
        a.Add(b);
        return a;
      });
  return sums.Facts();
}

}  // namespace latvox

#endif  // HWY_ONCE
