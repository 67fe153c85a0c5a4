// The parts that every example needs.
#ifndef LATVOX_CLIENT_EXAMPLES_EXAMPLE_H_
#define LATVOX_CLIENT_EXAMPLES_EXAMPLE_H_

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "absl/status/statusor.h"

namespace example {

inline absl::StatusOr<std::string> Read(const char* path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (!file.is_open()) return absl::NotFoundError(std::string(path) + ": cannot be opened");
  if (bytes.empty()) return absl::InvalidArgumentError(std::string(path) + ": is empty, or no file");
  return bytes;
}

inline uint32_t Number(const char* text) { return static_cast<uint32_t>(std::strtoul(text, nullptr, 10)); }

inline int Usage(const char* usage) { return std::fprintf(stderr, "usage: %s\n", usage), 2; }

inline int Fail(const absl::Status& status) {
  std::fprintf(stderr, "%s\n", status.ToString().c_str());  // GetErrorDetails reads its details
  return 1;
}

}  // namespace example

#endif  // LATVOX_CLIENT_EXAMPLES_EXAMPLE_H_
