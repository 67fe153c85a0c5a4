#include "client/python/status.h"

#include <pybind11/pybind11.h>

#include "absl/time/time.h"
#include "client/python/arguments.h"
#include "client/tool/cli/exit_status.h"
#include "latvox/error.h"

namespace latvox::client::python {

namespace py = pybind11;

void Check(const absl::Status& status) {
  if (status.ok()) return;
  const ErrorDetails details = GetErrorDetails(status);
  py::dict facts;
  for (const auto& [name, text] : {std::pair("reason", details.reason),
                                   {"field", details.field},
                                   {"value", details.value},
                                   {"limit", details.limit},
                                   {"other", details.other}}) {
    if (!text.empty()) facts[name] = WithKeywords(text);
  }
  if (details.retry_after) facts["retry_after"] = absl::ToDoubleSeconds(*details.retry_after);
  const py::object make = py::module_::import("latvox._errors").attr("error_of");
  const py::object error = make(absl::StatusCodeToString(status.code()), WithKeywords(ErrorText(status)), facts);
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
  throw py::error_already_set();
}

py::list ListOf(const std::vector<Warning>& warnings) {
  py::list all;
  for (const auto& [code, message, element] : warnings) all.append(py::make_tuple(message, code, element));
  return all;
}

}  // namespace latvox::client::python
