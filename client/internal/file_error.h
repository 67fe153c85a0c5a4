// Errors about files.
#ifndef LATVOX_CLIENT_INTERNAL_FILE_ERROR_H_
#define LATVOX_CLIENT_INTERNAL_FILE_ERROR_H_

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "latvox/error.h"

namespace latvox::client {

// Returns the error with the file as its ErrorDetails, if its message begins with the path, and it has no field yet.
//   field   what names the file: "--out", "mesh"
//   limit   the formats that the field can have, if the file's format is at fault
inline absl::Status WithFile(absl::Status error, const std::string& field, const std::string& path,
                             const std::string& limit = "") {
  if (error.ok() || !absl::StartsWith(error.message(), absl::StrCat(path, ":"))) return error;
  if (!GetErrorDetails(error).field.empty()) return error;
  const char* const reason = !absl::IsInvalidArgument(error) ? "" : field == "mesh" ? "BAD_MESH" : "BAD_SPEC";
  SetErrorDetails({reason, field, path, limit, std::nullopt}, error);
  return error;
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_FILE_ERROR_H_
