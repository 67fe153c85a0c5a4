#include "client/python/work.h"

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <set>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/python/ending.h"
#include "client/python/status.h"
#include "client/tool/cli/abandoned_work.h"
#include "client/tool/vdb/vdb.h"
#include "deploy/process/exhaustion.h"

namespace latvox::client::python {
namespace {

namespace py = pybind11;

constexpr auto kGlance = std::chrono::milliseconds(50);

// Guarded by the GIL.
std::set<Work*>& AllWork() {
  static auto& all = *new std::set<Work*>;
  return all;
}

}  // namespace

void EndWork() {
  if (!CheckProcess().ok()) return;  // a fork lacks the threads that it would wait for
  BeginEnd();
  for (Work* const work : AllWork()) work->Cancel();
  AwaitAllOutside();
  for (Work* const work : AllWork()) work->Join();  // nobody waits for it
}

absl::Status CheckProcess() {
  static std::atomic<pid_t> first = 0;
  pid_t process = 0;
  if (first.compare_exchange_strong(process, getpid()) || process == getpid()) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("process ", getpid(), " is a fork of process ", process,
                   ", which had used latvox before; use latvox only after the fork, or start processes by "
                   "multiprocessing's spawn or forkserver"));
}

void LeaveOutExitHandlers() {
  static const pid_t process = getpid();
  // The last handler runs first.
  const auto end = [](int status, void*) {
    if (getpid() == process && !AnyAbandoned() && Vdb::State() != VdbState::kLoading) return;
    std::fflush(nullptr);
    _exit(status);
  };
  if (on_exit(end, nullptr) != 0) throw std::bad_alloc();
}

Work::Work(std::function<absl::Status(Work&)> work) {
  CheckNotEnding();
  thread_ = std::thread([this, work = std::move(work)] {
    absl::Status status;
    try {
      status = work(*this);
      if (Vdb::State() == VdbState::kLoaded) {
        [[maybe_unused]] static const bool once = (LeaveOutExitHandlers(), true);
      }
    } catch (const std::exception& error) {
      status = StatusOf(error);
    }
    Change([&] {
      status_ = std::move(status);
      ended_ = true;
    });
  });
  AllWork().insert(this);
}

Work::~Work() {
  Cancel();
  Join();
  AllWork().erase(this);
}

void Work::Join() {
  const WithoutGil without_gil;
  if (thread_.joinable()) thread_.join();
}

void Work::Cancel() {
  cancellation_.Cancel();
  const std::lock_guard lock(mutex_);
  changed_.notify_all();
}

void Work::Change(const std::function<void()>& change) {
  const std::lock_guard lock(mutex_);
  change();
  changed_.notify_all();
}

absl::Status Work::AwaitReady(const std::function<bool()>& is_ready) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return cancellation_.cancelled() || is_ready(); });
  return cancellation_.cancelled() ? absl::CancelledError("cancelled") : absl::OkStatus();
}

bool Work::Await(const std::function<bool()>& is_ready, const std::function<void()>& glance) {
  for (;;) {
    {
      const WithoutGil without_gil;
      std::unique_lock lock(mutex_);
      if (changed_.wait_for(lock, kGlance, [&] { return ended_ || is_ready(); })) return ended_;
    }
    try {
      if (InPython([] { return PyErr_CheckSignals(); }) != 0) throw py::error_already_set();
      if (glance) glance();
    } catch (const py::error_already_set&) {
      Cancel();
      Join();
      throw;
    }
  }
}

void Run(const std::function<absl::Status(Work&)>& work) {
  Work running(work);
  running.Await([] { return false; });
  Check(running.status());
}

void RunOnFiles(const std::function<absl::Status(Work&)>& work) {
  Check(CheckProcess());  // oneTBB's threads do not exist in a fork either
  Run(work);
}

}  // namespace latvox::client::python
