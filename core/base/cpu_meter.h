// The CPU time of one job, whichever threads it runs on.
#ifndef LATVOX_CORE_BASE_CPU_METER_H_
#define LATVOX_CORE_BASE_CPU_METER_H_

#include <pthread.h>

#include <algorithm>
#include <ctime>
#include <mutex>
#include <utility>
#include <vector>

namespace latvox {

// Adds up the CPU time of scopes. It does not depend on how busy the machine is. Threads: any.
class CpuMeter {
 public:
  // Counts what this thread does from here to the scope's end. A scope within another one of the meter counts nothing
  // more: a thread that waits may take up a task with a scope of its own.
  class Scope {
   public:
    explicit Scope(CpuMeter& meter) : Scope(&meter) {}
    // Null counts nothing.
    explicit Scope(CpuMeter* meter)
        : meter_(meter),
          outer_(std::exchange(of_thread, meter)),
          clock_(ClockOfThread()),
          counts_(meter != nullptr && meter->Begin(clock_)) {}
    ~Scope() {
      if (counts_) meter_->End(clock_);
      of_thread = outer_;
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    CpuMeter* const meter_;
    CpuMeter* const outer_;
    const clockid_t clock_;
    const bool counts_;
  };

  // The meter of the innermost scope of this thread; null: there is none.
  static CpuMeter* OfThread() { return of_thread; }

  // Includes the scopes that have begun.
  double Seconds() const {
    const std::lock_guard lock(mutex_);
    double seconds = ended_;
    for (const Running& running : running_) seconds += Read(running.clock) - running.begun;
    return seconds;
  }

 private:
  struct Running {
    clockid_t clock;
    double begun;
  };

  static clockid_t ClockOfThread() {
    clockid_t clock = CLOCK_THREAD_CPUTIME_ID;
    pthread_getcpuclockid(pthread_self(), &clock);
    return clock;
  }
  static double Read(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
  }
  auto Find(clockid_t clock) {
    return std::find_if(running_.begin(), running_.end(), [&](const Running& r) { return r.clock == clock; });
  }
  // Returns false if the thread is in a scope already.
  bool Begin(clockid_t clock) {
    const double now = Read(clock);
    const std::lock_guard lock(mutex_);
    if (Find(clock) != running_.end()) return false;
    running_.push_back({clock, now});
    return true;
  }
  void End(clockid_t clock) {
    const double now = Read(clock);
    const std::lock_guard lock(mutex_);
    const auto mine = Find(clock);
    ended_ += now - mine->begun;
    *mine = running_.back();
    running_.pop_back();
  }

  static inline thread_local CpuMeter* of_thread = nullptr;

  mutable std::mutex mutex_;
  double ended_ = 0;              // seconds; guarded by mutex_, as is the next
  std::vector<Running> running_;  // one for each thread at work
};

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_CPU_METER_H_
