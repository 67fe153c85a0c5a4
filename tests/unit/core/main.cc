// The main program of core's tests. It is GoogleTest's, except that LATVOX_SIMD chooses the kernels, as it does for
// latvoxd. Exits with status 77, which ctest counts as skipped, if this processor lacks them.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "core/base/simd.h"

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  if (const char* name = std::getenv("LATVOX_SIMD")) {
    const std::optional<latvox::Simd> simd = latvox::SimdNamed(name);
    if (!simd) {
      std::fprintf(stderr, "LATVOX_SIMD: %s is no kernel\n", name);
      return 2;
    }
    if (const absl::Status forced = latvox::ForceSimd(*simd); !forced.ok()) {
      std::fprintf(stderr, "skipped: %s\n", forced.ToString().c_str());
      return 77;
    }
  }
  return RUN_ALL_TESTS();
}
