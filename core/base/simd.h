// Chooses the kernels. They are compiled for several instruction sets, and one is chosen at run time. All give the same
// bits, so the choice affects speed alone.
#ifndef LATVOX_CORE_BASE_SIMD_H_
#define LATVOX_CORE_BASE_SIMD_H_

#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "absl/status/status.h"

namespace latvox {

// kScalar is plain C++, the reference for tests of the kernels. Kernels without a plain version use the vectors that
// each processor has, SSE2 for example. kBest is the widest instruction set of the machine. On processors other than
// x86-64 (NEON, for example) it is the only kernel.
enum class Simd { kScalar, kAvx2, kAvx512, kBest };

inline constexpr std::array<std::pair<Simd, std::string_view>, 4> kSimdNames{
    {{Simd::kScalar, "scalar"}, {Simd::kAvx2, "avx2"}, {Simd::kAvx512, "avx512"}, {Simd::kBest, "best"}}};

// Nullopt if no kernel has that name.
std::optional<Simd> SimdNamed(std::string_view name);

// Makes all jobs of the process use one kind of kernel from now on. Do not call it while jobs run. Errors:
// FAILED_PRECONDITION if this processor lacks the instructions.
absl::Status ForceSimd(Simd simd);

// Returns whether kernels are plain C++: by ForceSimd, or because the processor has no wide vectors.
bool SimdIsScalar();

// The name of the kernels in use: "scalar", "avx2", "avx512", or, where the processor has none of these, Highway's
// name.
std::string_view SimdInUse();

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_SIMD_H_
