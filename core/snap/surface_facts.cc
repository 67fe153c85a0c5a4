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

#include "core/snap/corner_list-inl.h"

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

void AddPlain(const CornerList& list, SurfaceSums& sums) {
  for (size_t t = 0; t < list.size; ++t) {
    const Vec3i a = list.Corner(0, t), b = list.Corner(1, t), c = list.Corner(2, t);
    if (!HasArea(a, b, c)) {
      ++sums.degenerate;
      if (a == b || b == c || c == a) continue;
    }
    const Hash ha = HashOf(a), hb = HashOf(b), hc = HashOf(c);
    for (size_t n = 0; n < 2; ++n) {
      const Hash product = Multiply(ha[n] ^ hb[n], ha[n] ^ hc[n]);
      for (size_t m = 0; m < 2; ++m) sums.products[n][m] ^= product[m];
      sums.corners[n] ^= ha[n];
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

using HashLanes = hn::Repartition<uint64_t, Lanes>;
using Hashes = hn::Vec<HashLanes>;

// Which of the triangles from place `first` on, up to kTriangleLanes, have no area modulo 2^32: a bit for each.
HWY_INLINE uint64_t FlatOnes(const CornerList& list, size_t first) {
  const Lanes d;
  const std::array<Ints3, 3> v = LoadCorners(list, first);
  const Ints3 normal = CrossOf(Minus(v[1], v[0]), Minus(v[2], v[0]));
  const auto flat = hn::Eq(hn::Or(hn::Or(normal[0], normal[1]), normal[2]), hn::Zero(d));
  uint64_t bits = 0;
  hn::StoreMaskBits(d, hn::And(flat, hn::FirstN(d, list.size - first)), reinterpret_cast<uint8_t*>(&bits));
  return bits;
}

// The hash: rounds of AES, each one to one, of which four leave no structure that differences of inputs could show
// [Daemen and Rijmen, The Design of Rijndael, 9.5: 25 active S-boxes]. Cheaper here than to keep a hash per vertex.
HWY_INLINE Hashes HashesOf(Ints positions) {
  alignas(16) static constexpr uint64_t kKeys[4][2] = {{0x243F6A8885A308D3, 0x13198A2E03707344},
                                                       {0xA4093822299F31D0, 0x082EFA98EC4E6C89},
                                                       {0x452821E638D01377, 0xBE5466CF34E90C6C},
                                                       {0xC0AC29B7C97C50DD, 0x3F84D5B5B5470917}};  // of pi
  const hn::Repartition<uint8_t, Lanes> bytes;
  auto block = hn::BitCast(bytes, positions);
  for (const uint64_t* key : kKeys) block = hn::AESRound(block, hn::BitCast(bytes, hn::LoadDup128(HashLanes(), key)));
  return hn::BitCast(HashLanes(), block);
}

void AddProducts(const CornerList& list, SurfaceSums& sums) {
  const Lanes d;
  const HashLanes dh;
  constexpr size_t kRows = kTriangleLanes / 4;  // of a vector
  alignas(16) static constexpr int32_t kAxes[] = {-1, -1, -1, 0};
  const Ints axes = hn::LoadDup128(d, kAxes);
  Hashes first = hn::Zero(dh), second = first, corners = first;
  for (size_t t = 0; t < list.size; t += kRows) {
    const auto hashes = [&](size_t n)
                            HWY_ATTR { return HashesOf(hn::And(hn::LoadU(d, list.corners[n][t].data()), axes)); };
    Hashes a = hashes(0), x = hn::Xor(a, hashes(1));
    const Hashes y = hn::Xor(a, hashes(2));
    if (list.size - t < kRows) {
      const auto given = hn::FirstN(dh, 2 * (list.size - t));
      a = hn::IfThenElseZero(given, a);
      x = hn::IfThenElseZero(given, x);
    }
    first = hn::Xor(first, hn::CLMulLower(x, y));
    second = hn::Xor(second, hn::CLMulUpper(x, y));
    corners = hn::Xor(corners, a);
  }
  const auto add = [&](Hashes of, Hash& sum) HWY_ATTR {
    uint64_t halves[2 * kRows];
    hn::StoreU(of, dh, halves);
    for (size_t n = 0; n < 2 * kRows; ++n) sum[n % 2] ^= halves[n];
  };
  add(first, sums.products[0]);
  add(second, sums.products[1]);
  add(corners, sums.corners);
}

// Triangles of two equal corners are few: what they added is taken away by adding it again.
void AddInLanes(const CornerList& list, SurfaceSums& sums) {
  CornerList collapsed;
  for (size_t first = 0; first < list.size; first += kTriangleLanes) {
    for (uint64_t bits = FlatOnes(list, first); bits != 0; bits &= bits - 1) {
      const size_t t = first + static_cast<size_t>(std::countr_zero(bits));
      const Vec3i a = list.Corner(0, t), b = list.Corner(1, t), c = list.Corner(2, t);
      if (HasArea(a, b, c)) continue;
      ++sums.degenerate;
      if (a == b || b == c || c == a) collapsed.Append(list, t);
    }
  }
  AddProducts(list, sums);
  if (collapsed.size > 0) AddProducts(collapsed, sums);
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
        for (size_t n = part.begin(); n < part.end() && !cancelled; n += CornerList::kMost) {
          list.Fill(mesh, n, std::min(CornerList::kMost, part.end() - n));
          s.Add(list);
        }
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
