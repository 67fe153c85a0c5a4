// Triangles in the lanes, form after form.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/digitize/touching.cc"
#include "core/digitize/touching.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>

#include "core/base/append_lanes-inl.h"
#include "core/digitize/line_forms.h"
#include "core/snap/padded_vertices.h"
#include "core/snap/triangle_lanes-inl.h"

namespace latvox {
#ifndef LATVOX_CORE_DIGITIZE_TOUCHING_CC_ONCE
#define LATVOX_CORE_DIGITIZE_TOUCHING_CC_ONCE
namespace {

bool Touches(const LineForms& forms, const std::array<Vec3i, 3>& v) {
  std::array<bool, kMaxForms> between{};
  for (size_t n = 0; n < forms.between; ++n) {
    const auto floor = [&](size_t corner) { return Dot(forms.forms[n], v[corner]) >> kSubvoxelBits; };
    between[n] = floor(0) != floor(1) || floor(0) != floor(2);
  }
  return std::any_of(forms.of_frame.begin(), forms.of_frame.end(),
                     [&](const auto& frame) { return between[frame.form[0]] && between[frame.form[1]]; });
}

void FindScalar(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const LineForms& forms,
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
void FindInLanes(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const LineForms& forms,
                 std::vector<uint32_t>& touching) {
  FindScalar(mesh, triangles, forms, touching);
}
#else

namespace hn = hwy::HWY_NAMESPACE;

void FindInLanes(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const LineForms& forms,
                 std::vector<uint32_t>& touching) {
  const Lanes d;
  const hn::RebindToUnsigned<Lanes> du;
  const PaddedVertices vertices(mesh);
  const size_t before = touching.size();
  touching.resize(before + triangles.size() + kTriangleLanes);
  uint32_t* end = touching.data() + before;
  for (size_t first = 0; first < triangles.size(); first += kTriangleLanes) {
    const auto some = triangles.subspan(first, std::min(kTriangleLanes, triangles.size() - first));
    PrefetchCorners(mesh, triangles.subspan(first));
    const LaneNumbers numbers(some);
    const std::array<Ints3, 3> v = LoadCorners(mesh, vertices, numbers, {});
    // A bit for each form between whose floors at the corners there is a difference.
    Ints between = hn::Zero(d);
    for (size_t n = 0; n < forms.between; ++n) {
      const Ints3 value = ValuesOf(d, forms.forms[n], v);
      const Ints differs = hn::Or(hn::Xor(value[0], value[1]), hn::Xor(value[0], value[2]));
      const auto same_floor = hn::Eq(hn::ShiftRight<kSubvoxelBits>(differs), hn::Zero(d));
      between = hn::Or(between, hn::IfThenZeroElse(same_floor, Fill(1 << n)));
    }
    auto touches = hn::FirstN(d, 0);
    for (const auto& frame : forms.of_frame) {
      const Ints both = Fill(1 << frame.form[0] | 1 << frame.form[1]);
      touches = hn::Or(touches, hn::Eq(hn::And(between, both), both));
    }
    touches = hn::And(touches, hn::FirstN(d, some.size()));
    end += AppendLanes(du, numbers.Load(), hn::RebindMask(du, touches), end);
  }
  touching.resize(static_cast<size_t>(end - touching.data()));
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "core/base/simd.h"

namespace latvox {
namespace {

HWY_EXPORT(FindInLanes);

}  // namespace

void FindTouching(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const std::vector<ScanFrame>& frames,
                  std::vector<uint32_t>& touching) {
  const LineForms forms(frames);
  SimdIsScalar() ? FindScalar(mesh, triangles, forms, touching)
                 : HWY_DYNAMIC_DISPATCH(FindInLanes)(mesh, triangles, forms, touching);
}

}  // namespace latvox
#endif  // HWY_ONCE
