// Kernels that tests choose by themselves.
#ifndef LATVOX_TESTS_UNIT_CORE_SIMD_H_
#define LATVOX_TESTS_UNIT_CORE_SIMD_H_

#include <gtest/gtest.h>

#include <set>
#include <string_view>
#include <vector>

#include "core/base/simd.h"

namespace latvox {

// Chooses the kernels for as long as it lives, and leaves the choice as it found it.
class ForcedSimd {
 public:
  explicit ForcedSimd(Simd simd) { EXPECT_TRUE(ForceSimd(simd).ok()); }
  ~ForcedSimd() { EXPECT_TRUE(ForceSimd(before_).ok()); }
  ForcedSimd(const ForcedSimd&) = delete;
  ForcedSimd& operator=(const ForcedSimd&) = delete;

 private:
  const Simd before_ = SimdNamed(SimdInUse()).value_or(Simd::kBest);
};

// The kernels that this processor can run, each once, plain C++ first:
//   for (const Simd simd : SimdHere()) { const ForcedSimd forced(simd); ... }
inline std::vector<Simd> SimdHere() {
  const ForcedSimd restored(Simd::kBest);
  std::vector<Simd> here;
  std::set<std::string_view> names;
  for (const auto& [simd, name] : kSimdNames) {
    if (ForceSimd(simd).ok() && names.insert(SimdInUse()).second) here.push_back(simd);
  }
  return here;
}

// Calls f with each of them.
template <class F>
void WithEachSimd(const F& f) {
  for (const Simd simd : SimdHere()) {
    const ForcedSimd forced(simd);
    SCOPED_TRACE(SimdInUse());
    f();
  }
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_SIMD_H_
