// Stops work early: the owner of a StopSource requests it, and the work polls its StopSignal.
#ifndef LATVOX_CORE_BASE_STOP_SIGNAL_H_
#define LATVOX_CORE_BASE_STOP_SIGNAL_H_

#include <atomic>

namespace latvox {

// Tells work whether to stop. A function with a signal returns soon after the signal is stopped, with a meaningless
// result. A signal without a source never stops. It is a pointer: copies are free, and Stopped() is one load. It must
// not outlive its source. (std::stop_token would share the ownership, with two atomic additions for each copy.)
class StopSignal {
 public:
  StopSignal() = default;
  bool Stopped() const { return *stopped_; }

 private:
  friend class StopSource;
  static inline const std::atomic<bool> kNever = false;

  explicit StopSignal(const std::atomic<bool>& stopped) : stopped_(&stopped) {}

  const std::atomic<bool>* stopped_ = &kNever;
};

// Stops the work that has its signal. Thread-safe. Loads and stores are sequentially consistent.
class StopSource {
 public:
  StopSource() = default;
  StopSource(const StopSource&) = delete;
  StopSource& operator=(const StopSource&) = delete;

  void Stop() { stopped_ = true; }
  // Lets work go on that begins later. Precondition: no work runs.
  void Reset() { stopped_ = false; }
  bool Stopped() const { return stopped_; }
  StopSignal Signal() const { return StopSignal(stopped_); }

 private:
  std::atomic<bool> stopped_ = false;
};

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_STOP_SIGNAL_H_
