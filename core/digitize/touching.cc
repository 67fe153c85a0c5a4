// Triangles in the lanes, form after form.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/digitize/touching.cc"
#include "core/digitize/touching.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>

#include "core/base/append_lanes-inl.h"
#include "core/snap/padded_vertices.h"

namespace latvox {
#ifndef LATVOX_CORE_DIGITIZE_TOUCHING_CC_ONCE
#define LATVOX_CORE_DIGITIZE_TOUCHING_CC_ONCE
namespace {

constexpr size_t kMaxForms = 2 * kMaxPairs;
static_assert(kMaxForms < 32);

// The rows of all frames up to sign, and for each frame its two.
struct Forms {
  std::vector<Vec3i> rows;
  std::vector<std::array<size_t, 2>> of_frame;

  explicit Forms(const std::vector<ScanFrame>& frames) {
    for (const ScanFrame& scan : frames) {
      auto& pair = of_frame.emplace_back();
      for (size_t axis = 0; axis < 2; ++axis) {
        Vec3i row = scan.frame.r[axis];
        if (!FirstNonzeroIsPositive(row)) row = -row;
        pair[axis] = static_cast<size_t>(std::find(rows.begin(), rows.end(), row) - rows.begin());
        if (pair[axis] == rows.size()) rows.push_back(row);
      }
    }
  }
};

bool Touches(const Forms& forms, const std::array<Vec3i, 3>& v) {
  std::array<bool, kMaxForms> between{};
  for (size_t n = 0; n < forms.rows.size(); ++n) {
    // With a first nonzero entry above 0, the shift moves the form up.
    const auto floor = [&](size_t corner) { return Dot(forms.rows[n], v[corner]) >> kSubvoxelBits; };
    between[n] = floor(0) != floor(1) || floor(0) != floor(2);
  }
  return std::any_of(forms.of_frame.begin(), forms.of_frame.end(),
                     [&](const auto& pair) { return between[pair[0]] && between[pair[1]]; });
}

void FindScalar(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const Forms& forms,
                std::vector<uint32_t>& touching) {
  for (const uint32_t t : triangles) {
    const auto& [v0, v1, v2] = mesh.triangles[t];
    if (Touches(forms, {mesh.vertices_lat[v0], mesh.vertices_lat[v1], mesh.vertices_lat[v2]})) touching.push_back(t);
  }
}

}  // namespace
#endif
}  // namespace latvox

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR
void FindInLanes(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const Forms& forms,
                 std::vector<uint32_t>& touching) {
  FindScalar(mesh, triangles, forms, touching);
}
#else

namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kLanes = HWY_LANES(int32_t);

void FindInLanes(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const Forms& forms,
                 std::vector<uint32_t>& touching) {
  const hn::ScalableTag<int32_t> d;
  const hn::CappedTag<int32_t, 4> d4;
  const hn::RebindToUnsigned<decltype(d)> du;
  using V = hn::Vec<decltype(d)>;
  const PaddedVertices vertices(mesh);
  const V above_fraction = hn::Set(d, ~(kLatticeUnit - 1));
  const size_t before = touching.size();
  touching.resize(before + triangles.size() + kLanes);
  uint32_t* end = touching.data() + before;
  for (size_t first = 0; first < triangles.size(); first += kLanes) {
    const size_t count = std::min(kLanes, triangles.size() - first);
    alignas(64) int32_t corners[3][kLanes][4];
    alignas(64) uint32_t numbers[kLanes];
    for (size_t t = 0; t < kLanes; ++t) {
      numbers[t] = triangles[first + std::min(t, count - 1)];
      const auto& indices = mesh.triangles[numbers[t]];
      for (size_t n = 0; n < 3; ++n) hn::Store(hn::LoadU(d4, vertices[indices[n]]), d4, corners[n][t]);
    }
    V v[3][3];
    for (size_t n = 0; n < 3; ++n) {
      V unused;
      hn::LoadInterleaved4(d, corners[n][0], v[n][0], v[n][1], v[n][2], unused);
    }
    // A bit for each form between whose floors at the corners there is a difference.
    V between = hn::Zero(d);
    for (size_t n = 0; n < forms.rows.size(); ++n) {
      const auto value = [&](const V(&corner)[3]) HWY_ATTR {
        V sum = hn::Zero(d);
        for (size_t m = 0; m < 3; ++m) {
          const int32_t c = forms.rows[n][m];
          sum = c == 0    ? sum
                : c == 1  ? hn::Add(sum, corner[m])
                : c == -1 ? hn::Sub(sum, corner[m])
                          : hn::Add(sum, hn::Mul(corner[m], hn::Set(d, c)));
        }
        return sum;
      };
      const V a = value(v[0]), b = value(v[1]), c = value(v[2]);
      const V differs = hn::And(hn::Or(hn::Xor(a, b), hn::Xor(a, c)), above_fraction);
      const V bit = hn::Set(d, static_cast<int32_t>(1U << n));
      between = hn::Or(between, hn::IfThenZeroElse(hn::Eq(differs, hn::Zero(d)), bit));
    }
    auto touches = hn::FirstN(d, 0);
    for (const auto& [a, b] : forms.of_frame) {
      const V both = hn::Set(d, static_cast<int32_t>(1U << a | 1U << b));
      touches = hn::Or(touches, hn::Eq(hn::And(between, both), both));
    }
    touches = hn::And(touches, hn::FirstN(d, count));
    end += AppendLanes(du, hn::Load(du, numbers), hn::RebindMask(du, touches), end);
  }
  touching.resize(static_cast<size_t>(end - touching.data()));
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <array>
#include <numeric>

#include "core/base/simd.h"

namespace latvox {
namespace {

HWY_EXPORT(FindInLanes);

void Find(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const Forms& forms,
          std::vector<uint32_t>& touching) {
  SimdIsScalar() ? FindScalar(mesh, triangles, forms, touching)
                 : HWY_DYNAMIC_DISPATCH(FindInLanes)(mesh, triangles, forms, touching);
}

// Whether triangles spread over the mesh say that it pays to ask all.
bool FewTouch(const SnappedMesh& mesh, const Forms& forms) {
  constexpr size_t kSample = 1024;
  const size_t count = mesh.triangles.size();
  if (count < 16 * kSample) return false;
  std::vector<uint32_t> sample(kSample), touching;
  for (size_t n = 0; n < kSample; ++n) sample[n] = static_cast<uint32_t>(n * count / kSample);
  Find(mesh, sample, forms, touching);
  return touching.size() < kSample / 4 * 3;
}

}  // namespace

void FindTouching(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const std::vector<ScanFrame>& frames,
                  std::vector<uint32_t>& touching) {
  Find(mesh, triangles, Forms(frames), touching);
}

std::optional<std::vector<uint32_t>> TouchingIfFew(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames,
                                                   const std::atomic<bool>& cancelled) {
  constexpr size_t kChunk = 1 << 14;
  const Forms forms(frames);
  if (!FewTouch(mesh, forms)) return std::nullopt;
  const size_t count = mesh.triangles.size();
  std::vector<std::vector<uint32_t>> parts((count + kChunk - 1) / kChunk);
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<size_t>(0, parts.size()), [&](const auto& numbers) {
    std::vector<uint32_t> chunk(kChunk), touching;
    for (size_t n = numbers.begin(); n < numbers.end() && !cancelled; ++n) {
      chunk.resize(std::min(kChunk, count - n * kChunk));
      std::iota(chunk.begin(), chunk.end(), static_cast<uint32_t>(n * kChunk));
      touching.clear();
      Find(mesh, chunk, forms, touching);
      parts[n].assign(touching.begin(), touching.end());
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
