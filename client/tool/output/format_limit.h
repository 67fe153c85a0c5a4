// Errors of results that do not fit into a format.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_FORMAT_LIMIT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_FORMAT_LIMIT_H_

#include <string>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "client/internal/file_error.h"
#include "latvox/error.h"

namespace latvox::client {

inline constexpr char kAnySize[] = ".vdb, .h5 and .vtu hold any number of voxels";

// Returns RESOURCE_EXHAUSTED with ErrorDetails: "TARGET: WHAT; REMEDY".
//   what            has the value and the limit
//   value, limit    as texts
//   remedy          names formats that can hold it
inline absl::Status TooLarge(const std::string& target, const std::string& what, const std::string& value,
                             const std::string& limit, const std::string& remedy = kAnySize) {
  absl::Status status = absl::ResourceExhaustedError(absl::StrCat(target, ": ", what, "; ", remedy));
  SetErrorDetails({"LIMIT_EXCEEDED", "--out", value, limit, std::nullopt}, status);
  return status;
}

inline constexpr char kCellsHeld[] = "--lattice cartesian";  // the limit of formats for cells along the axes

// Returns INVALID_ARGUMENT with ErrorDetails: "TARGET: WHAT".
inline absl::Status NoSuchCells(const std::string& target, const std::string& what) {
  return WithFile(absl::InvalidArgumentError(absl::StrCat(target, ": ", what)), "--out", target, kCellsHeld);
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_FORMAT_LIMIT_H_
