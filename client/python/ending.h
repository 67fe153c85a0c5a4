// The end of Python while daemon threads run.
//
// Python then ends each thread that takes the GIL, by unwinding its frames. Those of C++ would run their destructors
// without the GIL, and the process would crash. So the end waits until no thread has frames of this module. It does not
// wait for functions of the caller, which may never return.
#ifndef LATVOX_CLIENT_PYTHON_ENDING_H_
#define LATVOX_CLIENT_PYTHON_ENDING_H_

#include <cxxabi.h>
#include <pybind11/pybind11.h>

namespace latvox::client::python {

[[noreturn]] void SleepForEver();

// Returns call(), which uses Python's C API. If Python ends the thread in it, the thread sleeps for ever, as from
// Python 3.14 on. So `call` itself must have nothing to destroy.
template <class Call>
auto InPython(Call call) try {
  return call();
} catch (abi::__forced_unwind&) {
  SleepForEver();
}

// Calls a function of Python with a tuple of arguments. Throws its exception. Requires the GIL.
pybind11::object CallPython(pybind11::handle function, pybind11::handle arguments);

// Likewise, for a function of the caller. The end of Python does not wait for its return.
void CallBack(pybind11::handle function, pybind11::handle arguments);

// The end of Python waits while it lives. All functions that Python calls, except those of a moment, have one. Requires
// the GIL.
class Inside {
 public:
  // Throws CANCELLED in threads that come after the end has begun.
  Inside();
  ~Inside();
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;
};

// Releases the GIL while it lives. The end of Python waits for it, too. After the end has begun it keeps the GIL,
// because a thread that takes the GIL later may never get it.
class WithoutGil {
 public:
  WithoutGil();
  ~WithoutGil();
  WithoutGil(const WithoutGil&) = delete;
  WithoutGil& operator=(const WithoutGil&) = delete;

 private:
  PyThreadState* const state_;  // null: the GIL is kept
};

// Begins the end, in the calling thread. Requires the GIL, as the next two do.
void BeginEnd();
// Throws CANCELLED if the end has begun.
void CheckNotEnding();
// Waits until no thread has frames of this module, except those in functions of the caller.
void AwaitAllOutside();

}  // namespace latvox::client::python

#endif  // LATVOX_CLIENT_PYTHON_ENDING_H_
