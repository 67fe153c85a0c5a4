// Triangles in the lanes, all directions one after the other. Few lines lie between corners, and most of these miss the
// triangle.
//
// Along q a lattice line is a point (a, b) of the projection (core/lattice/frame.h). It can only meet a triangle whose
// corners lie on both sides of a, and on both sides of b (core/digitize/touching.h). With one integer between the
// values of either form, let the corners be (x, y) relative to that line: it meets the triangle iff the origin lies
// inside, which is to say that
//   e[n] = x[n] * y[n+1] - x[n+1] * y[n],   n = 0, 1, 2,
// all have one sign. That need not be decided where e is close to 0: whatever is let pass, FindTinyCrossings decides
// (core/digitize/tiny.h). So 16 bits do, and the few units that products are rounded by.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/digitize/sift.cc"
#include "core/digitize/sift.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>

#include "core/base/append_lanes-inl.h"
#include "core/digitize/line_forms.h"
#include "core/snap/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR
void SiftInLanes(const SnappedMesh&, std::span<const uint32_t> triangles, const LineForms&, MetLines* met,
                 std::vector<uint32_t>& kept) {
  for (const uint32_t t : triangles) met[t] = kNotTiny;
  kept.insert(kept.end(), triangles.begin(), triangles.end());
}
#else

namespace hn = hwy::HWY_NAMESPACE;

using ShortLanes = hn::ScalableTag<int16_t>;
using Shorts = hn::Vec<ShortLanes>;
using Shorts3 = std::array<Shorts, 3>;
using ShortMask = hn::Mask<ShortLanes>;
constexpr size_t kSiftLanes = 2 * kTriangleLanes;

// Positions are within kNearest of a voxel close to the triangle, else it is not taken for tiny; values of forms are
// sums of kMaxFrameRow of these at most.
constexpr int16_t kNearest = 16 * kLatticeUnit;
static_assert(kMaxFrameRow * kNearest < 1 << 15);

// |x|, |y| <= kLatticeUnit are given kScaleBits more, and their products lose 15 of twice that: e is then in units of
// 2^(15 - 2 * kScaleBits), off by kSlack at most.
constexpr int kScaleBits = 6;
constexpr int16_t kSlack = 1;
static_assert(kSubvoxelBits + kScaleBits < 15);

// What Sift says of some triangles by their corners, in `lines`; returns which of them are tiny.
HWY_INLINE ShortMask LinesOf(const LineForms& forms, const std::array<Shorts3, 3>& v, Shorts& lines) {
  const ShortLanes d;
  Shorts farthest = hn::Zero(d);
  for (const Shorts3& corner : v) {
    for (const Shorts x : corner) farthest = hn::Max(farthest, hn::Max(x, hn::Not(x)));  // -x - 1, which always fits
  }
  ShortMask tiny = hn::Lt(farthest, hn::Set(d, kNearest)), between[kMaxForms];
  Shorts3 values[kMaxForms];  // relative to the last integer that is not above all of a form's
  for (size_t n = 0; n < forms.forms.size(); ++n) {
    const Shorts3 value = ValuesOf(d, forms.forms[n], v);
    const Shorts first = hn::ShiftRight<kSubvoxelBits>(hn::Min(value[0], hn::Min(value[1], value[2])));
    const Shorts last = hn::ShiftRight<kSubvoxelBits>(hn::Max(value[0], hn::Max(value[1], value[2])));
    const Shorts from = hn::ShiftLeft<kSubvoxelBits>(last);
    for (size_t c = 0; c < 3; ++c) values[n][c] = hn::ShiftLeft<kScaleBits>(hn::Sub(value[c], from));
    const Shorts integers = hn::Sub(last, first);
    tiny = hn::And(tiny, hn::Lt(integers, hn::Set(d, 2)));
    between[n] = hn::Gt(integers, hn::Zero(d));
  }
  lines = hn::Zero(d);
  for (size_t n = 0; n < forms.of_frame.size(); ++n) {
    const size_t a = forms.of_frame[n].form[0], b = forms.of_frame[n].form[1];
    const Shorts3 &x = values[a], &y = values[b];
    const auto edge = [&](size_t from, size_t to) HWY_ATTR {
      return hn::Sub(hn::MulFixedPoint15(x[from], y[to]), hn::MulFixedPoint15(x[to], y[from]));
    };
    const Shorts3 e{edge(0, 1), edge(1, 2), edge(2, 0)};
    const Shorts least = hn::Min(e[0], hn::Min(e[1], e[2])), most = hn::Max(e[0], hn::Max(e[1], e[2]));
    const auto inside = hn::Or(hn::Gt(least, hn::Set(d, -kSlack - 1)), hn::Lt(most, hn::Set(d, kSlack + 1)));
    const auto may_meet = hn::And(inside, hn::And(between[a], between[b]));
    lines = hn::Or(lines, hn::IfThenElseZero(may_meet, hn::Set(d, static_cast<int16_t>(1 << n))));
  }
  lines = hn::IfThenElse(tiny, lines, hn::Set(d, static_cast<int16_t>(kNotTiny)));
  return tiny;
}

// The corners of up to kSiftLanes triangles, by axis, relative to a voxel close to the first one; what does not fit is
// as far away as can be.
HWY_INLINE std::array<Shorts3, 3> LoadNear(const SnappedMesh& mesh, const PaddedVertices& vertices,
                                           const LaneNumbers& low, const LaneNumbers& high) {
  const ShortLanes d;
  const hn::Half<ShortLanes> half;
  const std::array<Ints3, 3> u = LoadCorners(mesh, vertices, low, {}), v = LoadCorners(mesh, vertices, high, {});
  std::array<Shorts3, 3> near;
  for (size_t m = 0; m < 3; ++m) {
    const Ints fraction = Fill(kLatticeUnit - 1), from_u = hn::AndNot(fraction, u[0][m]);
    const Ints from_v = hn::AndNot(fraction, v[0][m]);
    for (size_t c = 0; c < 3; ++c) {
      near[c][m] =
          hn::Combine(d, hn::DemoteTo(half, hn::Sub(v[c][m], from_v)), hn::DemoteTo(half, hn::Sub(u[c][m], from_u)));
    }
  }
  return near;
}

void SiftInLanes(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const LineForms& forms, MetLines* met,
                 std::vector<uint32_t>& kept) {
  const ShortLanes d;
  const hn::RebindToUnsigned<Lanes> du;
  const hn::Half<ShortLanes> half;
  const PaddedVertices vertices(mesh);
  const size_t before = kept.size();
  kept.resize(before + triangles.size() + kSiftLanes);
  uint32_t* end = kept.data() + before;
  for (size_t n = 0; n < triangles.size(); n += kSiftLanes) {
    const auto some = triangles.subspan(n, std::min(kSiftLanes, triangles.size() - n));
    PrefetchCorners(mesh, triangles.subspan(n));
    PrefetchCorners(mesh, triangles.subspan(std::min(n + kTriangleLanes, triangles.size())));
    const LaneNumbers low(some), high(some.subspan(std::min(kTriangleLanes, some.size() - 1)));
    Shorts lines;
    const ShortMask tiny = LinesOf(forms, LoadNear(mesh, vertices, low, high), lines);
    if (hn::CountTrue(d, tiny) < kSiftLanes / 4) lines = hn::Set(d, static_cast<int16_t>(kNotTiny));  // not worth it
    lines = hn::IfThenElseZero(hn::FirstN(d, some.size()), lines);
    alignas(64) int16_t lines_of[kSiftLanes];
    hn::Store(lines, d, lines_of);
    for (size_t m = 0; m < some.size(); ++m) met[some[m]] = static_cast<MetLines>(lines_of[m]);
    const auto keep = [&](hn::Vec<hn::Half<ShortLanes>> of) HWY_ATTR {
      return hn::RebindMask(du, hn::Ne(hn::PromoteTo(Lanes(), of), hn::Zero(Lanes())));
    };
    end += AppendLanes(du, low.Load(), keep(hn::LowerHalf(half, lines)), end);
    end += AppendLanes(du, high.Load(), keep(hn::UpperHalf(half, lines)), end);
  }
  kept.resize(static_cast<size_t>(end - kept.data()));
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <numeric>

#include "core/base/huge_pages.h"
#include "core/base/simd.h"
#include "core/digitize/touching.h"

namespace latvox {
namespace {

HWY_EXPORT(SiftInLanes);

}  // namespace

void Sift(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const std::vector<ScanFrame>& frames,
          std::span<MetLines> met, std::vector<uint32_t>& kept) {
  if (!SimdIsScalar()) return HWY_DYNAMIC_DISPATCH(SiftInLanes)(mesh, triangles, LineForms(frames), met.data(), kept);
  for (const uint32_t t : triangles) met[t] = kNotTiny;
  kept.insert(kept.end(), triangles.begin(), triangles.end());
}

std::vector<uint32_t> SiftAll(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const Fineness& fineness,
                              const std::atomic<bool>& cancelled, UninitializedVector<MetLines>& met) {
  constexpr size_t kChunk = 1 << 14;
  const size_t count = mesh.triangles.size();
  if (fineness.most_tiny) {
    met.resize(count);
    AdviseHugePages(met.data(), count * sizeof(MetLines));
  }
  std::vector<std::vector<uint32_t>> parts((count + kChunk - 1) / kChunk);
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<size_t>(0, parts.size()), [&](const auto& numbers) {
    std::vector<uint32_t> kept, next;
    for (size_t n = numbers.begin(); n < numbers.end() && !cancelled; ++n) {
      kept.resize(std::min(kChunk, count - n * kChunk));
      std::iota(kept.begin(), kept.end(), static_cast<uint32_t>(n * kChunk));
      if (fineness.few_touch) {
        next.clear();
        FindTouching(mesh, kept, frames, next);
        kept.swap(next);
      }
      if (fineness.most_tiny) {
        next.clear();
        Sift(mesh, kept, frames, met, next);
        kept.swap(next);
      }
      parts[n].assign(kept.begin(), kept.end());
    }
  });
  size_t size = 0;
  for (const auto& part : parts) size += part.size();
  std::vector<uint32_t> all;
  all.reserve(size);
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

}  // namespace latvox
#endif  // HWY_ONCE
