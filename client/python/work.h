// Work that Python waits for.
#ifndef LATVOX_CLIENT_PYTHON_WORK_H_
#define LATVOX_CLIENT_PYTHON_WORK_H_

#include <pybind11/pybind11.h>
#include <sys/types.h>
#include <unistd.h>

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "absl/status/status.h"
#include "latvox/cancellation.h"

namespace latvox::client::python {

// Returns FAILED_PRECONDITION if this process is a fork of one that had called this function: the threads of gRPC and
// of oneTBB do not exist in it, and its connections belong to the other process.
absl::Status CheckProcess();

// Call it when the module is loaded, and again after OpenVDB is. If this process then ends as a fork, or with an
// abandoned thread of client/tool/cli/abandoned_work.h, it leaves out the exit handlers of libraries that were loaded
// before. In a fork, log4cplus's would wait forever for a thread that does not exist there. OpenVDB brings it.
void LeaveOutExitHandlers();

// Deletes an object in the process that made it. In a fork, an object with threads or a server must stay as it is.
struct DeleteInItsProcess {
  pid_t process = getpid();
  template <class T>
  void operator()(T* object) const {
    if (getpid() == process) delete object;
  }
};
template <class T>
using OfProcess = std::unique_ptr<T, DeleteInItsProcess>;

// For the end of Python, when daemon threads still run: cancels all work, waits until it has ended and its threads have
// left this module, and lets no new work begin. Requires the GIL.
void EndWork();

// Work on a thread of its own, which never needs the GIL. The destructor cancels it and waits for its end.
class Work {
 public:
  // Throws CANCELLED after EndWork. Requires the GIL, as the destructor does.
  explicit Work(std::function<absl::Status(Work&)> work);
  ~Work();
  Work(const Work&) = delete;
  Work& operator=(const Work&) = delete;

  // Stops the work soon. Any thread may call it.
  void Cancel();
  const Cancellation& cancellation() const { return cancellation_; }

  // For the work: runs `change` under the lock of all predicates, and wakes those who wait.
  void Change(const std::function<void()>& change);
  // For the work: waits for `is_ready`. Errors: CANCELLED.
  absl::Status AwaitReady(const std::function<bool()>& is_ready);

  // For Python, with the GIL, which it releases: waits until `is_ready`, or until the work has ended. Meanwhile runs
  // the handlers of signals and `glance`, twenty times a second. If one of these throws, such as KeyboardInterrupt,
  // cancels the work, waits for its end, and throws that. Returns whether the work has ended.
  bool Await(const std::function<bool()>& is_ready, const std::function<void()>& glance = nullptr);
  // After its end.
  const absl::Status& status() const { return status_; }

 private:
  friend void EndWork();
  void Join();

  const Cancellation cancellation_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;   // guarded by mutex_
  absl::Status status_;  // set before ended_
  std::thread thread_;
};

// Runs the work and waits for it as above. Throws its error.
void Run(const std::function<absl::Status(Work&)>& work);

// Likewise for work on files, which may need threads that a fork lacks. Throws FAILED_PRECONDITION as CheckProcess.
void RunOnFiles(const std::function<absl::Status(Work&)>& work);

}  // namespace latvox::client::python

#endif  // LATVOX_CLIENT_PYTHON_WORK_H_
