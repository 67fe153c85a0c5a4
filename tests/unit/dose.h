// How much of a long test is run. Under a sanitizer or an emulator, a program takes 5 to 20 times as long, and a part
// of the cases is enough to find its faults. For core's tests, the plain build runs all cases, and decides whether
// results are right.
#ifndef LATVOX_TESTS_UNIT_DOSE_H_
#define LATVOX_TESTS_UNIT_DOSE_H_

namespace latvox {

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define LATVOX_SLOWED
#endif
#endif

#ifdef LATVOX_SLOWED
inline constexpr bool kSlowed = true;
#else
inline constexpr bool kSlowed = false;
#endif

// `all` cases of something, or `some` if the program is slowed.
template <class T>
constexpr T Dose(T all, T some) {
  return kSlowed ? some : all;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_DOSE_H_
