#include "client/python/status.h"

#include <pybind11/pybind11.h>

#include "absl/time/time.h"
#include "client/python/arguments.h"
#include "client/python/ending.h"
#include "client/tool/cli/exit_status.h"
#include "latvox/error.h"

namespace latvox::client::python {

namespace py = pybind11;

namespace {

// Returns the function that makes an exception of a status.
py::object ErrorOf() {
  PyObject* const module = InPython([] { return PyImport_ImportModule("latvox._errors"); });
  if (module == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(module).attr("error_of");
}

// Returns a text with bytes that are not UTF-8, such as those of a file's name.
//   errors   Python's handler of such bytes: "surrogateescape" returns what os.fsdecode returns, and any program can
//            print what "backslashreplace" returns
py::str TextOf(const std::string& text, const char* errors) {
  PyObject* const decoded = PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), errors);
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

}  // namespace

void Check(const absl::Status& status) {
  if (status.ok()) return;
  const ErrorDetails details = GetErrorDetails(status);
  py::dict facts;
  for (const auto& [name, text] : {std::pair("reason", details.reason),
                                   {"field", details.field},
                                   {"value", details.value},
                                   {"limit", details.limit},
                                   {"other", details.other}}) {
    if (!text.empty()) facts[name] = TextOf(WithKeywords(text), "surrogateescape");
  }
  if (details.retry_after) facts["retry_after"] = absl::ToDoubleSeconds(*details.retry_after);
  const py::tuple arguments = py::make_tuple(absl::StatusCodeToString(status.code()),
                                             TextOf(WithKeywords(ErrorText(status)), "backslashreplace"), facts);
  const py::object error = CallPython(ErrorOf(), arguments);
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
  throw py::error_already_set();
}

py::list ListOf(const std::vector<Warning>& warnings) {
  py::list all;
  for (const auto& [code, message, element] : warnings) {
    all.append(py::make_tuple(TextOf(message, "backslashreplace"), code, TextOf(element, "surrogateescape")));
  }
  return all;
}

}  // namespace latvox::client::python
