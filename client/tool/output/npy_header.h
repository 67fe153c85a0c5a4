// The head of .npy files.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_NPY_HEADER_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_NPY_HEADER_H_

#include <cstdint>
#include <span>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

// Returns the header in numpy.lib.format version 1.0: magic, header length, a Python dictionary padded with spaces. For
// one type the length is the same for every shape of at most three sides.
//   type   as Python writes it: "'<i4'"; at most 110 characters
inline std::string NpyHeader(absl::string_view type, std::span<const uint64_t> shape) {
  const size_t bytes = type.size() <= 46 ? 128 : 192;  // a multiple of 64
  std::string header("\x93NUMPY\x01\x00", 8);
  header.push_back(static_cast<char>(bytes - 10));
  header.push_back(0);
  absl::StrAppend(&header, "{'descr': ", type, ", 'fortran_order': False, 'shape': (", absl::StrJoin(shape, ", "),
                  shape.size() == 1 ? "," : "", "), }");
  header.resize(bytes - 1, ' ');
  return header + "\n";
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_NPY_HEADER_H_
