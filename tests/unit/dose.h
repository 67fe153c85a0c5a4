// How much of a long test is run. Under a sanitizer, a program takes 5 to 20 times as long, and a part of the cases is
// enough to find its faults. The plain build runs all cases, and decides whether results are right.
#ifndef LATVOX_TESTS_UNIT_DOSE_H_
#define LATVOX_TESTS_UNIT_DOSE_H_

namespace latvox {

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define LATVOX_SANITIZED
#endif
#endif

#ifdef LATVOX_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

// `all` cases of something, or under a sanitizer `some`.
template <class T>
constexpr T Dose(T all, T some) {
  return kSanitized ? some : all;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_DOSE_H_
