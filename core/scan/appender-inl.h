// Appends the candidates of vectors of lines to lists.
#if defined(LATVOX_CORE_SCAN_APPENDER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_SCAN_APPENDER_INL_H_
#undef LATVOX_CORE_SCAN_APPENDER_INL_H_
#else
#define LATVOX_CORE_SCAN_APPENDER_INL_H_
#endif

#include <hwy/highway.h>

#include "core/base/append_lanes-inl.h"
#include "core/scan/candidates.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// The box that candidates must lie in: its size, and the number of its low corner, from which voxels count here.
struct Target {
  Vec3i size;
  BitsLayout layout;
  int32_t number;
};

// Holds the ends of the candidates' lists, in registers.
class Appender {
 public:
  // Reserves room for `most` candidates.
  HWY_INLINE Appender(Candidates& out, size_t most) : out_(out) {
    out.Reserve(most);
    nearer_ = out.nearer.end();
    farther_ = out.farther.end();
    rim_ = out.rim.end();
  }
  HWY_INLINE ~Appender() {
    if (nearer_ == nullptr) return;
    out_.nearer.Grow(static_cast<size_t>(nearer_ - out_.nearer.end()));
    out_.farther.Grow(static_cast<size_t>(farther_ - out_.farther.end()));
    out_.rim.Grow(static_cast<size_t>(rim_ - out_.rim.end()));
  }
  Appender(const Appender&) = delete;
  Appender& operator=(const Appender&) = delete;

  // Leaves the lists as they were.
  void Drop() { nearer_ = nullptr; }

  // Lanes hold a voxel with the triangle's place above it, and the step to the farther end of its link along the
  // principal direction.
  template <class D>
  HWY_INLINE void Append(D d, hn::Vec<D> voxel, hn::Vec<D> to_farther, hn::Mask<D> crossed, hn::Mask<D> rim) {
    const SelectedLanes<D> selected(d, crossed);
    selected.Store(voxel, nearer_);
    selected.Store(hn::Add(voxel, to_farther), farther_);
    nearer_ += selected.count();
    farther_ += selected.count();
    rim_ += AppendLanes(d, voxel, rim, rim_);
  }
  // Does the same for a supercover. The lanes' second voxels are in it where `sure` says so, and may be for `open`.
  template <class D>
  HWY_INLINE void AppendCover(D d, hn::Vec<D> voxel, hn::Vec<D> to_second, hn::Mask<D> crossed, hn::Mask<D> rim,
                              hn::Mask<D> sure, hn::Mask<D> open) {
    const auto second = hn::Add(voxel, to_second);
    nearer_ += AppendLanes(d, voxel, crossed, nearer_);
    nearer_ += AppendLanes(d, second, sure, nearer_);
    farther_ += AppendLanes(d, second, open, farther_);
    rim_ += AppendLanes(d, voxel, rim, rim_);
  }

 private:
  Candidates& out_;
  uint32_t *nearer_, *farther_, *rim_;
};

// Returns v + by where the mask says so. Masks of bits make one instruction of a choice, and masks of whole lanes two.
template <class D, class V = hn::Vec<D>>
HWY_INLINE V AddIf(D, hn::Mask<D> mask, V v, V by) {
#if HWY_TARGET <= HWY_AVX3
  return hn::IfThenElse(mask, hn::Add(v, by), v);
#else
  return hn::Add(v, hn::IfThenElseZero(mask, by));
#endif
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
