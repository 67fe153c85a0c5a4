#include "core/lattice/cube_root.h"

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <limits>

namespace latvox {
namespace {

using Integer = boost::multiprecision::uint256_t;

constexpr int kDigits = std::numeric_limits<double>::digits;

// x == integer * 2^exponent.
struct Parts {
  uint64_t integer;
  int exponent;
};

Parts PartsOf(double x) {
  int exponent = 0;
  const double fraction = std::frexp(x, &exponent);
  return {static_cast<uint64_t>(std::ldexp(fraction, kDigits)), exponent - kDigits};
}

// Returns whether the cube root of x is below the middle between `root` and the next double. It is never the middle,
// because the cube of an odd number of 54 bits has more bits than x. Precondition: `root` is within a factor of 2.
bool IsBelowMiddle(double x, double root) {
  const Parts of_x = PartsOf(x), of_root = PartsOf(root);
  const Integer middle = 2 * Integer(of_root.integer) + 1;  // times 2^(of_root.exponent - 1)
  return Integer(of_x.integer) << (of_x.exponent - 3 * (of_root.exponent - 1)) < middle * middle * middle;
}

}  // namespace

// The cbrt of the library can be wrong by some units in the last place, and differs between libraries. That of long
// doubles is rounded twice, and long doubles of ARM have more digits than those of x86-64.
double CubeRoot(double x) {
  double root = std::cbrt(x);
  while (!IsBelowMiddle(x, root)) root = std::nextafter(root, std::numeric_limits<double>::infinity());
  for (double less; IsBelowMiddle(x, less = std::nextafter(root, 0.0));) root = less;
  return root;
}

}  // namespace latvox
