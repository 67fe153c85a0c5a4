#include "core/base/simd.h"

#include <hwy/targets.h>

#include <atomic>
#include <string>

#include "absl/strings/str_cat.h"

namespace latvox {
namespace {

std::atomic<bool> scalar_only = false;

#if HWY_ARCH_X86
constexpr int64_t kAvx512Targets = HWY_AVX3 | HWY_AVX3_DL;
constexpr int64_t kAvx2Targets = HWY_AVX2;
#else
constexpr int64_t kAvx512Targets = 0, kAvx2Targets = 0;
#endif

}  // namespace

std::optional<Simd> SimdNamed(std::string_view name) {
  for (const auto& [simd, known] : kSimdNames) {
    if (known == name) return simd;
  }
  return std::nullopt;
}

absl::Status ForceSimd(Simd simd) {
  hwy::DisableTargets(0);
  const int64_t here = hwy::SupportedTargets();
  const int64_t needed = simd == Simd::kAvx512 ? kAvx512Targets : kAvx2Targets;
  if ((simd == Simd::kAvx2 || simd == Simd::kAvx512) && (here & needed) == 0) {
    return absl::FailedPreconditionError(
        absl::StrCat("simd: this processor has no ", std::string(kSimdNames[static_cast<size_t>(simd)].second)));
  }
  if (simd == Simd::kAvx2) hwy::DisableTargets(kAvx512Targets);
  scalar_only = simd == Simd::kScalar;
  return absl::OkStatus();
}

bool SimdIsScalar() { return scalar_only; }

std::string_view SimdInUse() {
  if (SimdIsScalar()) return "scalar";
  const int64_t here = hwy::SupportedTargets();
  if ((here & kAvx512Targets) != 0) return "avx512";
  if ((here & kAvx2Targets) != 0) return "avx2";
  return hwy::TargetName(here & -here);
}

}  // namespace latvox
