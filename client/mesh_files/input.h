// Reads files and standard input.
#ifndef LATVOX_CLIENT_MESH_FILES_INPUT_H_
#define LATVOX_CLIENT_MESH_FILES_INPUT_H_

#include <string>

#include "absl/status/statusor.h"

namespace latvox::client {

// The path of standard input.
inline constexpr char kStandardInput[] = "-";

// Returns the path, or "standard input" for "-".
std::string NameOfInput(const std::string& path);

// Returns all bytes of the file.
// Errors, with the path: NOT_FOUND; INVALID_ARGUMENT (a directory, empty, cannot be opened); FAILED_PRECONDITION
// (reading fails midway, which may be temporary); RESOURCE_EXHAUSTED (memory); CANCELLED.
absl::StatusOr<std::string> ReadBytes(const std::string& path);

// Reads standard input to its end. `what` names the expected content: "a mesh".
// Errors: INVALID_ARGUMENT (a terminal, empty); FAILED_PRECONDITION; RESOURCE_EXHAUSTED; CANCELLED.
absl::StatusOr<std::string> ReadStandardInput(const char* what);

// From now on, every thread that waits for such bytes gets CANCELLED.
void StopReading();

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_INPUT_H_
