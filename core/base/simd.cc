#include "core/base/simd.h"

#include <hwy/highway_export.h>
#include <hwy/targets.h>

#include <atomic>
#include <cstdint>
#include <string>

#include "absl/strings/str_cat.h"

// While it is loaded, Highway's library calls this function for its own benchmarks, which are not ours. There it
// measures the clock, which takes milliseconds, by an instruction that some virtual machines hide: valgrind then ends
// the program. The dynamic linker lets this definition replace the library's. Newer libraries ask only when a benchmark
// runs. Weak: a static library may define it, too.
namespace hwy::platform {

HWY_DLLEXPORT uint64_t TimerResolution();
[[gnu::weak]] uint64_t TimerResolution() { return 1; }

}  // namespace hwy::platform

namespace latvox {
namespace {

std::atomic<bool> scalar_only = false;
std::atomic<int64_t> allowed = ~int64_t{0};

// It is slow to ask the processor: on virtual machines, the host answers.
int64_t Detected() {
  static const int64_t targets = hwy::SupportedTargets();
  return targets;
}

#if HWY_ARCH_X86
constexpr int64_t kAvx512Targets = HWY_AVX3 | HWY_AVX3_DL;
constexpr int64_t kAvx2Targets = HWY_AVX2;
#else
constexpr int64_t kAvx512Targets = 0, kAvx2Targets = 0;
#endif
constexpr int64_t kBaseline = HWY_STATIC_TARGET;  // what the compiler may use everywhere

}  // namespace

std::optional<Simd> SimdNamed(std::string_view name) {
  for (const auto& [simd, known] : kSimdNames) {
    if (known == name) return simd;
  }
  return std::nullopt;
}

absl::Status ForceSimd(Simd simd) {
  const int64_t needed = simd == Simd::kAvx512 ? kAvx512Targets : kAvx2Targets;
  if ((simd == Simd::kAvx2 || simd == Simd::kAvx512) && (Detected() & needed) == 0) {
    return absl::FailedPreconditionError(
        absl::StrCat("simd: this processor has no ", std::string(kSimdNames[static_cast<size_t>(simd)].second)));
  }
  scalar_only = simd == Simd::kScalar;
  allowed = simd == Simd::kScalar ? kBaseline : simd == Simd::kAvx2 ? ~kAvx512Targets : ~int64_t{0};
  // Not hwy::DisableTargets, because any call of hwy::SupportedTargets chooses all targets again.
  hwy::GetChosenTarget().Update(Detected() & allowed);
  return absl::OkStatus();
}

bool SimdIsScalar() { return scalar_only || (Detected() & ~(HWY_SCALAR | HWY_EMU128 | HWY_SSSE3 | HWY_SSE4)) == 0; }

std::string_view SimdInUse() {
  if (SimdIsScalar()) return "scalar";
  const int64_t targets = Detected() & allowed;
  if ((targets & kAvx512Targets) != 0) return "avx512";
  if ((targets & kAvx2Targets) != 0) return "avx2";
  const int64_t compiled = targets & HWY_TARGETS;  // without SVE, which processors with NEON may have
  return hwy::TargetName(compiled & -compiled);
}

}  // namespace latvox
