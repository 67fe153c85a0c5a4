#include "client/grid/metadata.h"

#include <array>
#include <charconv>
#include <cstring>

#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

constexpr char kString[] = "string", kBool[] = "bool", kInt32[] = "int32", kInt64[] = "int64", kDouble[] = "double",
               kVec3i[] = "vec3i";

template <class T>
MetadataValue OfType(const char* type, const T& value) {
  return {type, std::string(reinterpret_cast<const char*>(&value), sizeof(value))};
}

template <class T>
T ValueOf(const MetadataValue& value) {
  T number{};
  std::memcpy(&number, value.bytes.data(), sizeof(number));
  return number;
}

std::string TextOf(double number) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

}  // namespace

MetadataValue ToMetadata(const std::string& text) { return {kString, text}; }
MetadataValue ToMetadata(const char* text) { return {kString, text}; }
MetadataValue ToMetadata(bool value) { return OfType(kBool, value); }
MetadataValue ToMetadata(int32_t value) { return OfType(kInt32, value); }
MetadataValue ToMetadata(int64_t value) { return OfType(kInt64, value); }
MetadataValue ToMetadata(double value) { return OfType(kDouble, value); }
MetadataValue ToMetadata(const Vec3i& value) { return OfType(kVec3i, value); }

std::string MetadataText(const MetadataValue& value) {
  if (value.type == kBool) return ValueOf<bool>(value) ? "true" : "false";
  if (value.type == kInt32) return absl::StrCat(ValueOf<int32_t>(value));
  if (value.type == kInt64) return absl::StrCat(ValueOf<int64_t>(value));
  if (value.type == kDouble) return TextOf(ValueOf<double>(value));
  return value.bytes;
}

}  // namespace latvox::client
