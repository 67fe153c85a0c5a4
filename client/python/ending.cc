#include "client/python/ending.h"

#include <unistd.h>

#include <chrono>
#include <optional>
#include <thread>

#include "absl/status/status.h"
#include "client/python/status.h"

namespace latvox::client::python {
namespace {

namespace py = pybind11;

// Guarded by the GIL.
std::optional<std::thread::id> g_ender;  // the thread that began the end
int g_inside = 0;                        // how many Inside and WithoutGil live, without threads in CallBack

}  // namespace

void SleepForEver() {
  for (;;) pause();
}

py::object CallPython(py::handle function, py::handle arguments) {
  PyObject* const result = InPython([&] { return PyObject_CallObject(function.ptr(), arguments.ptr()); });
  if (result == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(result);
}

void CallBack(py::handle function, py::handle arguments) {
  struct Outside {
    Outside() { --g_inside; }
    ~Outside() { ++g_inside; }
  };
  const Outside outside;
  const bool is_done = InPython([&] {
    PyObject* const result = PyObject_CallObject(function.ptr(), arguments.ptr());
    Py_XDECREF(result);
    return result != nullptr;
  });
  if (!is_done) throw py::error_already_set();
}

Inside::Inside() {
  if (g_ender != std::this_thread::get_id()) CheckNotEnding();
  ++g_inside;
}

Inside::~Inside() { --g_inside; }

WithoutGil::WithoutGil() : state_(g_ender ? nullptr : (++g_inside, PyEval_SaveThread())) {}

WithoutGil::~WithoutGil() {
  if (state_ == nullptr) return;
  InPython([this] { PyEval_RestoreThread(state_); });
  --g_inside;
}

void BeginEnd() { g_ender = std::this_thread::get_id(); }

void CheckNotEnding() {
  if (g_ender) Check(absl::CancelledError("cancelled, because Python ends"));
}

void AwaitAllOutside() {
  while (g_inside > 0) {
    PyThreadState* const state = PyEval_SaveThread();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    PyEval_RestoreThread(state);
  }
}

}  // namespace latvox::client::python
