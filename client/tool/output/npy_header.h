// The head of .npy files.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_NPY_HEADER_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_NPY_HEADER_H_

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

// Returns the header in numpy.lib.format version 1.0: magic, header length, a Python dictionary padded with spaces. For
// one type the length is the same for every shape of at most three sides.
//   type   as Python writes it: "'<i4'"; at most 60000 characters
inline std::string NpyHeader(absl::string_view type, std::span<const uint64_t> shape) {
  constexpr size_t kStep = 64;  // all headers have a multiple of it
  const size_t bytes = 2 * kStep + (std::max<size_t>(type.size(), 46) - 46 + kStep - 1) / kStep * kStep;
  std::string header("\x93NUMPY\x01\x00", 8);
  header.push_back(static_cast<char>(bytes - 10));
  header.push_back(static_cast<char>((bytes - 10) >> 8));
  absl::StrAppend(&header, "{'descr': ", type, ", 'fortran_order': False, 'shape': (", absl::StrJoin(shape, ", "),
                  shape.size() == 1 ? "," : "", "), }");
  header.resize(bytes - 1, ' ');
  return header + "\n";
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_NPY_HEADER_H_
