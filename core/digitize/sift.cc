// Triangles in the lanes, all directions one after the other. Few lines lie between corners, and most of these miss the
// triangle.
//
// Along q a lattice line is a point (a, b) of the projection (core/lattice/frame.h). It can only meet a triangle whose
// corners lie on both sides of a, and on both sides of b (core/digitize/touching.h). With one integer between the
// values of either form, let the corners be (x, y) relative to that line: it meets the triangle iff the origin lies
// inside, which is to say that
//   e[n] = x[n] * y[n+1] - x[n+1] * y[n],   n = 0, 1, 2,
// all have one sign, 0 counting as either: ties are left to core/digitize/tiny.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/digitize/sift.cc"
#include "core/digitize/sift.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>

#include "core/base/append_lanes-inl.h"
#include "core/digitize/line_forms.h"
#include "core/digitize/triangle_lanes-inl.h"

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

using FloatLanes = hn::RebindToFloat<Lanes>;
using Floats = hn::Vec<FloatLanes>;
using Floats3 = std::array<Floats, 3>;
using FloatMask = hn::Mask<FloatLanes>;

// Floats are exact here: positions have up to kNearBits before the point, from a voxel close to the triangle, and forms
// two more; then e is a multiple of 1/kLatticeUnit^2, |e| <= 2, to which half a multiple is added.
constexpr int kFloatBits = 24, kNearBits = 10;
static_assert(kMaxFrameRow <= 4 && kNearBits + 2 + kSubvoxelBits <= kFloatBits);
static_assert(2 + 2 * kSubvoxelBits + 1 <= kFloatBits);
constexpr float kHalfOfMultiple = 0.5F / (kLatticeUnit * kLatticeUnit);

// What Sift says of up to kTriangleLanes triangles, in `lines`; returns which of them are tiny.
HWY_INLINE hn::Mask<Lanes> LinesOf(const LineForms& forms, const std::array<Ints3, 3>& v, Ints& lines) {
  const Lanes d;
  const FloatLanes df;
  std::array<Floats3, 3> corner;  // voxels, from one close to the first corner
  Ints farthest = hn::Zero(d);
  for (size_t m = 0; m < 3; ++m) {
    const Ints from = hn::AndNot(Fill(kLatticeUnit - 1), v[0][m]);
    for (size_t c = 0; c < 3; ++c) {
      const Ints at = hn::Sub(v[c][m], from);
      farthest = hn::Max(farthest, hn::Abs(at));
      corner[c][m] = hn::Mul(hn::ConvertTo(df, at), hn::Set(df, 1.0F / kLatticeUnit));
    }
  }
  auto tiny = hn::RebindMask(df, hn::Lt(farthest, Fill(1 << (kNearBits + kSubvoxelBits))));
  Floats3 values[kMaxForms];  // relative to the last integer that is not above all of a form's
  FloatMask between[kMaxForms];
  for (size_t n = 0; n < forms.forms.size(); ++n) {
    const Floats3 value = ValuesOf(df, forms.forms[n], corner);
    const Floats first = hn::Floor(hn::Min(value[0], hn::Min(value[1], value[2])));
    const Floats last = hn::Floor(hn::Max(value[0], hn::Max(value[1], value[2])));
    for (size_t c = 0; c < 3; ++c) values[n][c] = hn::Sub(value[c], last);
    const Floats integers = hn::Sub(last, first);
    tiny = hn::And(tiny, hn::Lt(integers, hn::Set(df, 2.0F)));
    between[n] = hn::Gt(integers, hn::Zero(df));
  }
  lines = hn::Zero(d);
  for (size_t n = 0; n < forms.of_frame.size(); ++n) {
    const size_t a = forms.of_frame[n].form[0], b = forms.of_frame[n].form[1];
    const Floats3 &x = values[a], &y = values[b];
    const auto edge = [&](size_t from, size_t to)
                          HWY_ATTR { return hn::NegMulAdd(x[to], y[from], hn::Mul(x[from], y[to])); };
    const Floats3 e{edge(0, 1), edge(1, 2), edge(2, 0)};
    // Half a unit turns what is 0 to the side of the sum: the lines that it lets pass FindTinyCrossings looks at
    // closely.
    const Floats sum = hn::Add(hn::Add(e[0], e[1]), e[2]);
    const Floats bias = hn::CopySignToAbs(hn::Set(df, 0.5F / (kLatticeUnit * kLatticeUnit)), sum);
    const auto side = [&](size_t m) HWY_ATTR { return hn::Add(e[m], bias); };
    const Floats differs = hn::Or(hn::Xor(side(0), side(1)), hn::Xor(side(0), side(2)));
    const auto two_sides = hn::RebindMask(df, hn::Lt(hn::BitCast(d, differs), hn::Zero(d)));
    const auto may_meet = hn::AndNot(two_sides, hn::And(tiny, hn::And(between[a], between[b])));
    lines = hn::Or(lines, hn::IfThenElseZero(hn::RebindMask(d, may_meet), Fill(1 << n)));
  }
  lines = hn::IfThenElse(hn::RebindMask(d, tiny), lines, Fill(kNotTiny));
  return hn::RebindMask(d, tiny);
}

void SiftInLanes(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const LineForms& forms, MetLines* met,
                 std::vector<uint32_t>& kept) {
  const Lanes d;
  const hn::RebindToUnsigned<Lanes> du;
  const PaddedVertices vertices(mesh);
  const size_t before = kept.size();
  kept.resize(before + triangles.size() + kTriangleLanes);
  uint32_t* end = kept.data() + before;
  for (size_t n = 0; n < triangles.size(); n += kTriangleLanes) {
    const auto some = triangles.subspan(n, std::min(kTriangleLanes, triangles.size() - n));
    PrefetchCorners(mesh, triangles.subspan(n));
    const LaneNumbers numbers(some);
    Ints lines;
    const auto given = hn::FirstN(d, some.size());
    const auto tiny = hn::And(given, LinesOf(forms, LoadCorners(mesh, vertices, numbers, {}), lines));
    if (hn::CountTrue(d, tiny) < kTriangleLanes / 4) lines = Fill(kNotTiny);  // not worth going through all directions
    alignas(64) int32_t lines_of[kTriangleLanes];
    hn::Store(lines, d, lines_of);
    for (size_t m = 0; m < some.size(); ++m) met[some[m]] = static_cast<MetLines>(lines_of[m]);
    const auto keep = hn::And(given, hn::Ne(lines, hn::Zero(d)));
    end += AppendLanes(du, numbers.Load(), hn::RebindMask(du, keep), end);
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
  if (fineness.most_tiny) met.resize(count);
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
