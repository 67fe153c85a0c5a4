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
#include "core/snap/surface_facts.h"

#define HWY_WANT_AVX3_DL         // which has AES for whole vectors
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/snap/padded_vertices.h"
#include "core/snap/triangle_lanes-inl.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

// What does not depend on the instruction set, once.
#ifndef LATVOX_CORE_SNAP_SURFACE_FACTS_ONCE_
#define LATVOX_CORE_SNAP_SURFACE_FACTS_ONCE_

namespace latvox {
namespace {

using Triangle = std::array<uint32_t, 3>;
using Hash = std::array<uint64_t, 2>;  // two polynomials in GF(2)[x], of degrees below 64

struct FactsSum {
  uint64_t degenerate = 0;
  std::array<Hash, 2> products{};  // of each half, the 128 bits of the sum of (a + b)(a + c)
  Hash corners{};                  // the sum of a

  void Add(const FactsSum& other) {
    degenerate += other.degenerate;
    for (size_t n = 0; n < 2; ++n) {
      for (size_t m = 0; m < 2; ++m) products[n][m] ^= other.products[n][m];
      corners[n] ^= other.corners[n];
    }
  }
};

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

// Counts the triangle if it has no area. Whether its edges count: no two of its corners are equal.
bool HasEdges(const SnappedMesh& mesh, const Triangle& triangle, FactsSum& sum) {
  const auto [i, j, k] = triangle;
  const Vec3i &a = mesh.vertices_lat[i], &b = mesh.vertices_lat[j], &c = mesh.vertices_lat[k];
  if (HasArea(a, b, c)) return true;
  ++sum.degenerate;
  return a != b && b != c && c != a;
}

FactsSum PlainSum(const SnappedMesh& mesh, const Triangle* triangles, size_t count) {
  FactsSum sum;
  for (size_t t = 0; t < count; ++t) {
    if (!HasEdges(mesh, triangles[t], sum)) continue;
    const auto [i, j, k] = triangles[t];
    const Hash ha = HashOf(mesh.vertices_lat[i]), hb = HashOf(mesh.vertices_lat[j]), hc = HashOf(mesh.vertices_lat[k]);
    for (size_t n = 0; n < 2; ++n) {
      const Hash product = Multiply(ha[n] ^ hb[n], ha[n] ^ hc[n]);
      for (size_t m = 0; m < 2; ++m) sum.products[n][m] ^= product[m];
      sum.corners[n] ^= ha[n];
    }
  }
  return sum;
}

}  // namespace
}  // namespace latvox

#endif  // LATVOX_CORE_SNAP_SURFACE_FACTS_ONCE_

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR  // which has no vectors of two

FactsSum Sum(const SnappedMesh& mesh, const Triangle* triangles, size_t count) {
  return PlainSum(mesh, triangles, count);
}

#else

// Whether any 128 bits of the vector are zero.
template <class V>
HWY_INLINE bool AnyBlockIsZero(V v) {
  const hn::DFromV<V> d;
  if constexpr (hn::MaxLanes(d) == 4) return hn::AllTrue(d, hn::Eq(v, hn::Zero(d)));
  uint64_t lanes = 0;
  hn::StoreMaskBits(d, hn::Eq(v, hn::Zero(d)), reinterpret_cast<uint8_t*>(&lanes));
  lanes &= lanes >> 1;
  return (lanes & lanes >> 2 & 0x1111'1111'1111'1111) != 0;
}

// Triangles at a time, each in 128 bits of a vector: as many blocks as one instruction of AES takes.
constexpr size_t kBlocks = HWY_TARGET == HWY_AVX3_DL ? 4 : 1;

FactsSum Sum(const SnappedMesh& mesh, const Triangle* triangles, size_t count) {
  const hn::FixedTag<int32_t, 4 * kBlocks> di;
  const hn::FixedTag<uint64_t, 2 * kBlocks> du;
  const hn::FixedTag<uint8_t, 16 * kBlocks> db;
  const PaddedVertices vertices(mesh);
  alignas(16) static constexpr int32_t kAxes[] = {-1, -1, -1, 0};
  alignas(16) static constexpr uint8_t kRotation[] = {4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 12, 13, 14, 15};
  const auto axes = hn::LoadDup128(di, kAxes);
  const auto rotation = hn::BitCast(di, hn::LoadDup128(db, kRotation));
  const auto rotated = [&](auto v) HWY_ATTR { return hn::TableLookupBytes(v, rotation); };
  // The hash: rounds of AES, each one to one, of which four leave no structure that differences of inputs could show
  // [Daemen and Rijmen, The Design of Rijndael, 9.5: 25 active S-boxes]. Cheaper here than to keep a hash per vertex.
  alignas(16) static constexpr uint64_t kKeys[4][2] = {{0x243F6A8885A308D3, 0x13198A2E03707344},
                                                       {0xA4093822299F31D0, 0x082EFA98EC4E6C89},
                                                       {0x452821E638D01377, 0xBE5466CF34E90C6C},
                                                       {0xC0AC29B7C97C50DD, 0x3F84D5B5B5470917}};  // of pi
  const auto key = [&](size_t n) HWY_ATTR { return hn::BitCast(db, hn::LoadDup128(du, kKeys[n])); };
  const auto k0 = key(0), k1 = key(1), k2 = key(2), k3 = key(3);
  const auto hash = [&](auto position) HWY_ATTR {
    const auto block = hn::AESRound(hn::AESRound(hn::BitCast(db, position), k0), k1);
    return hn::BitCast(du, hn::AESRound(hn::AESRound(block, k2), k3));
  };
  auto first = hn::Zero(du), second = first, corners = first;
  FactsSum sum;
  for (size_t t = 0; t < count; t += kBlocks) {
    // Behind the last triangle, others of one corner: they have no area, and do not count.
    Triangle padded[kBlocks]{};
    const size_t here = std::min(kBlocks, count - t);
    if (here < kBlocks) std::copy_n(&triangles[t], here, padded);
    const Triangle* const block = here < kBlocks ? padded : &triangles[t];
    const auto load = [&](size_t corner) HWY_ATTR {
      return hn::And(LoadRows(di, [&](size_t n) HWY_ATTR { return vertices[block[n][corner]]; }), axes);
    };
    const auto a = load(0), b = load(1), c = load(2);
    auto ha = hash(a), x = hn::Xor(ha, hash(b));
    const auto y = hn::Xor(ha, hash(c));
    // The axes of (b - a) x (c - a) modulo 2^32, rotated. Few triangles are left to be looked at closely.
    const auto u = hn::Sub(b, a), v = hn::Sub(c, a);
    const auto normal = hn::Sub(hn::Mul(u, rotated(v)), hn::Mul(rotated(u), v));
    if (AnyBlockIsZero(normal)) {
      alignas(64) Hash counts[kBlocks]{};
      for (size_t n = 0; n < here; ++n) {
        if (HasEdges(mesh, block[n], sum)) counts[n] = {~uint64_t{0}, ~uint64_t{0}};
      }
      ha = hn::And(ha, hn::Load(du, counts->data()));
      x = hn::And(x, hn::Load(du, counts->data()));
    }
    first = hn::Xor(first, hn::CLMulLower(x, y));
    second = hn::Xor(second, hn::CLMulUpper(x, y));
    corners = hn::Xor(corners, ha);
  }
  const auto total = [&](auto blocks) HWY_ATTR {
    Hash hashes[kBlocks], total{};
    hn::StoreU(blocks, du, hashes->data());
    for (const Hash& h : hashes) total = {total[0] ^ h[0], total[1] ^ h[1]};
    return total;
  };
  sum.products = {total(first), total(second)};
  sum.corners = total(corners);
  return sum;
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

HWY_EXPORT(Sum);

SurfaceFacts FactsOf(const SnappedMesh& mesh, const std::atomic<bool>& cancelled) {
  constexpr size_t kGrain = 4096;  // triangles a task
  using Part = oneapi::tbb::blocked_range<size_t>;
  const FactsSum sum = oneapi::tbb::parallel_reduce(
      Part(0, mesh.triangles.size(), kGrain), FactsSum{},
      [&](const Part& part, FactsSum s) {
        if (cancelled) return s;
        const Triangle* triangles = &mesh.triangles[part.begin()];
        s.Add(SimdIsScalar() ? PlainSum(mesh, triangles, part.size())
                             : HWY_DYNAMIC_DISPATCH(Sum)(mesh, triangles, part.size()));
        return s;
      },
      [](FactsSum a, const FactsSum& b) {
        a.Add(b);
        return a;
      });
  bool closed = true;
  for (size_t n = 0; n < 2; ++n) closed &= sum.products[n] == Multiply(sum.corners[n], sum.corners[n]);
  return {sum.degenerate, closed};
}

}  // namespace latvox

#endif  // HWY_ONCE
