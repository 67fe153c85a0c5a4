// Closedness as a polynomial identity. Give each position p an indeterminate X_p. Over GF(2),
//   sum of X_a * X_b over all edges ab of all triangles, a != b,
// keeps the edges that occur an odd number of times: it is the zero polynomial iff the mesh is closed. It is evaluated
// at a pseudo-random H_p, 64 bits of a hash of the position, as a polynomial in GF(2)[x]. A sum of degree 2 that is not
// zero vanishes for at most 2/2^64 of all choices (Schwartz-Zippel, in GF(2^64); sums are compared before reduction,
// which only distinguishes more). Two halves of a 128-bit hash, as if independent, make it 4/2^128.
//
// In characteristic 2,
//   ab + bc + ca = (a + b)(a + c) + a^2,
// and a sum of squares is the square of the sum. So one product is enough for a triangle. The edges of a triangle with
// two equal corners cancel, or do not count.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/triangles/surface_facts.cc"
#define HWY_WANT_AVX3_DL  // for AES of whole vectors
#include "core/triangles/surface_facts.h"

#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>

#include "core/base/metered.h"
#include "core/triangles/corner_list-inl.h"
#include "core/triangles/padded_vertices.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

// The code that does not depend on the instruction set, once.
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

using Corners = std::array<Vec3i, 3>;

// Counts a triangle without area. Returns whether its edges count: no two of its corners are equal.
bool HasEdges(const Corners& v, SurfaceSums& sums) {
  const auto& [a, b, c] = v;
  if (HasArea(a, b, c)) return true;
  ++sums.degenerate;
  return a != b && b != c && c != a;
}

//   list   null: no list is filled
void AddPlain(const SnappedMesh& mesh, size_t first, size_t count, const Vec3i& origin, CornerList* list,
              SurfaceSums& sums) {
  for (size_t t = 0; t < count; ++t) {
    const auto& [i, j, k] = mesh.triangles[first + t];
    const Corners v{mesh.vertices_lat[i], mesh.vertices_lat[j], mesh.vertices_lat[k]};
    if (list != nullptr) list->SetCorners(t, v, origin);
    if (!HasEdges(v, sums)) continue;
    const Hash a = HashOf(v[0]), b = HashOf(v[1]), c = HashOf(v[2]);
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

void AddInLanes(const SnappedMesh& mesh, size_t first, size_t count, const Vec3i& origin, CornerList* list,
                SurfaceSums& sums) {
  AddPlain(mesh, first, count, origin, list, sums);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

// The number of triangles at a time, each in 128 bits of a vector: as many blocks as one instruction of AES takes.
constexpr size_t kBlocks = HWY_TARGET == HWY_AVX3_DL ? 4 : 1;

using Positions = hn::FixedTag<int32_t, 4 * kBlocks>;
using Hashes = hn::FixedTag<uint64_t, 2 * kBlocks>;
using Bytes = hn::FixedTag<uint8_t, 16 * kBlocks>;

// The hash: rounds of AES. Each round is one to one, and after four of them, differences of inputs leave no structure
// [Daemen and Rijmen, The Design of Rijndael, 9.5: 25 active S-boxes]. This is cheaper here than a stored hash for each
// vertex.
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

// Returns which 128 bits of the vector are zero, as bits of their first lanes.
HWY_INLINE uint64_t ZeroBlocks(hn::Vec<Positions> v) {
  const Positions d;
  uint64_t lanes = 0;
  hn::StoreMaskBits(d, hn::Eq(v, hn::Zero(d)), reinterpret_cast<uint8_t*>(&lanes));
  lanes &= lanes >> 1;
  return lanes & lanes >> 2 & kFirstLanes;
}

// The sums of some triangles.
class Sums {
 public:
  HWY_INLINE Sums() : first_(hn::Zero(Hashes())), second_(first_), corners_(first_) {}

  // Adds the first `count` of kBlocks triangles with these corners.
  HWY_INLINE void Add(hn::Vec<Positions> a, hn::Vec<Positions> b, hn::Vec<Positions> c, size_t count,
                      SurfaceSums& sums) {
    const Positions d;
    alignas(16) static constexpr int32_t kAxes[] = {-1, -1, -1, 0};
    alignas(16) static constexpr uint8_t kRotation[] = {4, 5, 6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 12, 13, 14, 15};
    const auto axes = hn::LoadDup128(d, kAxes), rotation = hn::BitCast(d, hn::LoadDup128(Bytes(), kRotation));
    const auto rotated = [&](auto v) HWY_ATTR { return hn::TableLookupBytes(v, rotation); };
    a = hn::And(a, axes);
    b = hn::And(b, axes);
    c = hn::And(c, axes);
    auto h = HashesOf(a), x = hn::Xor(h, HashesOf(b));
    const auto y = hn::Xor(h, HashesOf(c));
    // The components of (b - a) x (c - a) modulo 2^32, rotated.
    const auto u = hn::Sub(b, a), v = hn::Sub(c, a);
    const auto normal = hn::Sub(hn::Mul(u, rotated(v)), hn::Mul(rotated(u), v));
    const uint64_t flat = ZeroBlocks(normal);
    if (flat != 0 || count < kBlocks) {
      uint64_t counts = 0;  // triangles with edges that count
      // Then products are below 2^30, and the normal is exact.
      const auto fits = hn::Lt(hn::Max(hn::Abs(u), hn::Abs(v)), hn::Set(d, 1 << 15));
      if (count == kBlocks && hn::AllTrue(d, fits)) {
        sums.degenerate += static_cast<uint64_t>(std::popcount(flat));
        counts = ~(ZeroBlocks(u) | ZeroBlocks(v) | ZeroBlocks(hn::Sub(u, v)));
      } else {
        std::array<int32_t, 4> corners[3][kBlocks];
        hn::StoreU(a, d, corners[0]->data());
        hn::StoreU(b, d, corners[1]->data());
        hn::StoreU(c, d, corners[2]->data());
        for (size_t n = 0; n < count; ++n) {
          Corners of;
          for (size_t m = 0; m < 3; ++m) of[m] = {corners[m][n][0], corners[m][n][1], corners[m][n][2]};
          counts |= uint64_t{HasEdges(of, sums)} << 4 * n;
        }
      }
      const uint64_t lanes = (counts & kFirstLanes) * 0xF;
      const auto kept = hn::LoadMaskBits(d, reinterpret_cast<const uint8_t*>(&lanes));
      const auto keep = [&](auto& hashes) HWY_ATTR {
        hashes = hn::BitCast(Hashes(), hn::IfThenElseZero(kept, hn::BitCast(d, hashes)));
      };
      keep(h);
      keep(x);
    }
    first_ = hn::Xor(first_, hn::CLMulLower(x, y));
    second_ = hn::Xor(second_, hn::CLMulUpper(x, y));
    corners_ = hn::Xor(corners_, h);
  }

  HWY_INLINE void AddTo(SurfaceSums& sums) const {
    const auto add = [&](auto blocks, Hash& sum) HWY_ATTR {
      Hash hashes[kBlocks];
      hn::StoreU(blocks, Hashes(), hashes->data());
      for (const Hash& hash : hashes) sum = {sum[0] ^ hash[0], sum[1] ^ hash[1]};
    };
    add(first_, sums.products[0]);
    add(second_, sums.products[1]);
    add(corners_, sums.corners);
  }

 private:
  hn::Vec<Hashes> first_, second_, corners_;
};

// Prefetches the vertices that are needed some triangles later. Prefetches the numbers of vertices even earlier,
// because a processor's own prefetcher stops at the end of each page.
void AddInLanes(const SnappedMesh& mesh, size_t first, size_t count, const Vec3i& origin, CornerList* list,
                SurfaceSums& sums) {
  constexpr size_t kVerticesAhead = 256, kNumbersAhead = 512;  // triangles
  using Numbers = std::array<uint32_t, 3>;
  const Positions d;
  const PaddedVertices vertices(mesh);
  const Numbers* const numbers = &mesh.triangles[first];
  const size_t left = mesh.triangles.size() - first;
  alignas(16) const int32_t low[] = {origin[0], origin[1], origin[2], 0};
  const auto origins = hn::LoadDup128(d, low);
  Sums some;
  const auto add = [&](const Numbers* of, size_t t, size_t given) HWY_ATTR {
    const auto corner = [&](size_t c)
                            HWY_ATTR { return LoadRows(d, [&](size_t m) HWY_ATTR { return vertices[of[m][c]]; }); };
    const auto a = corner(0), b = corner(1), c = corner(2);
    if (list != nullptr) StoreCorners(d, a, b, c, origins, *list, t);
    some.Add(a, b, c, given, sums);
  };
  size_t t = 0;
  for (; t + kBlocks <= count; t += kBlocks) {
    hwy::Prefetch(numbers + std::min(t + kNumbersAhead, left - kBlocks));
    const Numbers* const ahead = numbers + std::min(t + kVerticesAhead, left - kBlocks);
    for (size_t m = 0; m < kBlocks; ++m) {
      for (const uint32_t vertex : ahead[m]) hwy::Prefetch(vertices[vertex]);
    }
    add(numbers + t, t, kBlocks);
  }
  if (t < count) {
    Numbers padded[kBlocks];
    for (size_t m = 0; m < kBlocks; ++m) padded[m] = numbers[std::min(t + m, count - 1)];
    add(padded, t, count - t);
  }
  some.AddTo(sums);
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <oneapi/tbb/blocked_range.h>

#include "core/base/simd.h"

namespace latvox {

HWY_EXPORT(AddInLanes);

void SurfaceSums::Add(const SnappedMesh& mesh, size_t first, size_t count) {
  if (SimdIsScalar()) return AddPlain(mesh, first, count, {}, nullptr, *this);
  HWY_DYNAMIC_DISPATCH(AddInLanes)(mesh, first, count, {}, nullptr, *this);
}

void SurfaceSums::AddAndList(const SnappedMesh& mesh, size_t first, size_t count, const Vec3i& origin,
                             CornerList& list) {
  list.size = count;
  std::iota(list.triangles, list.triangles + count, static_cast<uint32_t>(first));
  if (SimdIsScalar()) return AddPlain(mesh, first, count, origin, &list, *this);
  HWY_DYNAMIC_DISPATCH(AddInLanes)(mesh, first, count, origin, &list, *this);
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

SurfaceFacts FactsOf(const SnappedMesh& mesh, StopSignal stop) {
  constexpr size_t kGrain = 4096;  // triangles for each task
  using Part = oneapi::tbb::blocked_range<size_t>;
  const SurfaceSums sums = MeteredReduce(
      Part(0, mesh.triangles.size(), kGrain), SurfaceSums{},
      [&](const Part& part, SurfaceSums s) {
        if (!stop.Stopped()) s.Add(mesh, part.begin(), part.size());
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
