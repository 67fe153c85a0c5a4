// Random choices from a printed seed.
#ifndef LATVOX_TESTS_FAULTS_CHANCE_H_
#define LATVOX_TESTS_FAULTS_CHANCE_H_

#include <cmath>
#include <cstdint>
#include <iterator>
#include <random>
#include <string>

namespace latvox::faults {

class Chance {
 public:
  explicit Chance(uint64_t seed) : bits_(seed) {}

  // Returns 0 to n - 1. Precondition: n > 0.
  uint64_t Below(uint64_t n) { return std::uniform_int_distribution<uint64_t>(0, n - 1)(bits_); }
  bool OneIn(uint64_t n) { return Below(n) == 0; }
  double Between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(bits_); }
  // Returns a number; each order of magnitude is equally likely.
  double LogBetween(double low, double high) { return std::exp(Between(std::log(low), std::log(high))); }
  template <class Container>
  auto& Of(Container& container) {
    return container[Below(std::size(container))];
  }
  std::string Bytes(size_t n) {
    std::string bytes(n, '\0');
    for (char& c : bytes) c = static_cast<char>(Below(256));
    return bytes;
  }

 private:
  std::mt19937_64 bits_;
};

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_CHANCE_H_
