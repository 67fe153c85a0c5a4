// Files and standard input, as bytes.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_INPUT_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_INPUT_H_

#include <string>

#include "absl/status/statusor.h"

namespace latvox::client {

// The path that stands for standard input.
inline constexpr char kStandardInput[] = "-";

// How people call it: "standard input" for that.
std::string NameOfInput(const std::string& path);

// All bytes of the file. Errors, with the path: NOT_FOUND; INVALID_ARGUMENT (a directory, empty, cannot be opened);
// FAILED_PRECONDITION (reading fails midway, which may pass); RESOURCE_EXHAUSTED (memory); CANCELLED.
absl::StatusOr<std::string> ReadBytes(const std::string& path);

// The same of standard input, which is read to its end, for what is wanted there ("a mesh"). Errors: INVALID_ARGUMENT
// (a terminal, empty); FAILED_PRECONDITION; RESOURCE_EXHAUSTED; CANCELLED.
absl::StatusOr<std::string> ReadStandardInput(const char* what);

// From now on, whoever waits for such bytes, in any thread, gets CANCELLED.
void StopReading();

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_INPUT_H_
