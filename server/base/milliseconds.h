// Durations as the log, the metrics and the contract show them.
#ifndef LATVOX_SERVER_BASE_MILLISECONDS_H_
#define LATVOX_SERVER_BASE_MILLISECONDS_H_

#include <chrono>

namespace latvox {

inline double Milliseconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double, std::milli>(duration).count();
}

inline double MillisecondsSince(std::chrono::steady_clock::time_point start) {
  return Milliseconds(std::chrono::steady_clock::now() - start);
}

// Adds the milliseconds of a scope to `sum`.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum) : sum_(sum), start_(std::chrono::steady_clock::now()) {}
  ~Stopwatch() { sum_ += MillisecondsSince(start_); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& sum_;
  const std::chrono::steady_clock::time_point start_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_MILLISECONDS_H_
