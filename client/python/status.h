// Errors of the SDK as exceptions of Python.
#ifndef LATVOX_CLIENT_PYTHON_STATUS_H_
#define LATVOX_CLIENT_PYTHON_STATUS_H_

#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace latvox::client::python {

// Throws the exception that latvox/_errors.py makes of the status, unless it is OK. Requires the GIL.
void Check(const absl::Status& status);

// Returns the value, or throws as above.
template <class T>
T Checked(absl::StatusOr<T> value) {
  Check(value.status());
  return *std::move(value);
}

}  // namespace latvox::client::python

#endif  // LATVOX_CLIENT_PYTHON_STATUS_H_
