// The header of a Stanford PLY file.
#ifndef LATVOX_CLIENT_MESH_FILES_PLY_HEADER_H_
#define LATVOX_CLIENT_MESH_FILES_PLY_HEADER_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };
enum class PlyScalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct PlyProperty {
  std::string name;
  PlyScalar type;
  std::optional<PlyScalar> count_type;  // for a list
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;
  size_t lines = 0;         // of the header
  bool ends_in_cr = false;  // its lines end in CR alone
  std::string unmarked;     // the first line that is a comment without "comment"
};

// Properties that belong together, such as x, y and z.
using PlyNames = std::array<const char*, 3>;
inline constexpr PlyNames kPlyAxes{"x", "y", "z"};

// Returns the index of the property in the names. Lists have none.
std::optional<size_t> PositionOf(const PlyProperty& property, const PlyNames& names);

// Returns the first name without a scalar property in the element, or null if all exist.
const char* Missing(const PlyElement& element, const PlyNames& names);

// Returns "uchar", "float", ...
absl::string_view NameOf(PlyScalar scalar);

// Reads the header off the front of `rest`. Errors: INVALID_ARGUMENT naming the line that is wrong or missing.
absl::StatusOr<PlyHeader> ReadPlyHeader(absl::string_view& rest);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_PLY_HEADER_H_
