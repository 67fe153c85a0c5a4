// Errors of the SDK as exceptions of Python, and warnings for latvox/_errors.py.
#ifndef LATVOX_CLIENT_PYTHON_STATUS_H_
#define LATVOX_CLIENT_PYTHON_STATUS_H_

#include <pybind11/pybind11.h>

#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "latvox/warning.h"

namespace latvox::client::python {

// Throws the exception that latvox/_errors.py makes of the status, unless it is OK. Requires the GIL.
void Check(const absl::Status& status);

// Returns a tuple for each warning: the arguments of VoxelizeWarning. Requires the GIL.
pybind11::list ListOf(const std::vector<Warning>& warnings);

// Returns the value, or throws as above.
template <class T>
T Checked(absl::StatusOr<T> value) {
  Check(value.status());
  return *std::move(value);
}

}  // namespace latvox::client::python

#endif  // LATVOX_CLIENT_PYTHON_STATUS_H_
