// Metadata of a grid, without OpenVDB. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_METADATA_H_
#define LATVOX_CLIENT_GRID_METADATA_H_

#include <cstdint>
#include <map>
#include <string>

#include "latvox/types.h"

namespace latvox::client {

// A value with its type, as a .vdb file has them.
struct MetadataValue {
  std::string type, bytes;
  bool operator==(const MetadataValue&) const = default;
};
using Metadata = std::map<std::string, MetadataValue>;  // by name, which is also the order of a file

// Return a value of the type "string", "bool", "int32", "int64", "double" and "vec3i".
MetadataValue ToMetadata(const std::string& text);
MetadataValue ToMetadata(const char* text);
MetadataValue ToMetadata(bool value);
MetadataValue ToMetadata(int32_t value);
MetadataValue ToMetadata(int64_t value);
MetadataValue ToMetadata(double value);
MetadataValue ToMetadata(const Vec3i& value);

// Returns the value as text for people. Numbers have as many digits as they need to be exact. Precondition: the value
// is one of ToMetadata, and no vec3i.
std::string MetadataText(const MetadataValue& value);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_METADATA_H_
