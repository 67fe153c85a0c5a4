// Which kernels run. They are compiled for several instruction sets, and one is chosen at run time; all give the same
// bits, so the choice concerns speed alone.
#ifndef LATVOX_CORE_BASE_SIMD_H_
#define LATVOX_CORE_BASE_SIMD_H_

#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "absl/status/status.h"

namespace latvox {

// kScalar is plain C++, the reference that the kernels are tested against. kBest is whatever is widest here: on
// processors other than x86-64 (NEON, for example) it is the only kernel.
enum class Simd { kScalar, kAvx2, kAvx512, kBest };

inline constexpr std::array<std::pair<Simd, std::string_view>, 4> kSimdNames{
    {{Simd::kScalar, "scalar"}, {Simd::kAvx2, "avx2"}, {Simd::kAvx512, "avx512"}, {Simd::kBest, "best"}}};

// Nullopt if there is none of that name.
std::optional<Simd> SimdNamed(std::string_view name);

// Makes all jobs of the process use one kind of kernel from now on. Not while jobs run.
// Errors: FAILED_PRECONDITION if this processor has no such instructions.
absl::Status ForceSimd(Simd simd);

// Whether ForceSimd asked for plain C++.
bool SimdIsScalar();

// The name of what runs: "scalar", "avx2", "avx512", or, where neither of these is to be had, Highway's name.
std::string_view SimdInUse();

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_SIMD_H_
