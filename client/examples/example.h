// What every example needs, and none is about.
#ifndef LATVOX_CLIENT_EXAMPLES_EXAMPLE_H_
#define LATVOX_CLIENT_EXAMPLES_EXAMPLE_H_

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "client/error.h"

namespace example {

inline std::string Read(const char* path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline uint32_t Number(const char* text) { return static_cast<uint32_t>(std::strtoul(text, nullptr, 10)); }

inline int Usage(const char* usage) { return std::fprintf(stderr, "usage: %s\n", usage), 2; }

inline int Fail(const absl::Status& status) {
  std::fprintf(stderr, "%s\n", status.ToString().c_str());
  if (const auto details = latvox::client::GetErrorDetails(status); !details.field.empty()) {
    std::fprintf(stderr, "field %s, limit %s\n", details.field.c_str(), details.limit.c_str());
  }
  return 1;
}

}  // namespace example

#endif  // LATVOX_CLIENT_EXAMPLES_EXAMPLE_H_
