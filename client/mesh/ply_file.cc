#include "client/mesh/ply_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/mesh/polygon.h"

// Why not assimp, which reads glTF: on a file cut short its PLY importer crashes or does not return, and it
// triangulates polygons before anyone could have checked their indices.
namespace latvox::client {
namespace {

enum class Format { kAscii, kLittleEndian, kBigEndian };
enum class Scalar { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };

struct Property {
  std::string name;
  Scalar type;
  std::optional<Scalar> count_type;  // of a list
};

struct Element {
  std::string name;
  uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::kAscii;
  std::vector<Element> elements;
};

template <class... Parts>
absl::Status Bad(const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat(parts...));
}

std::optional<Scalar> ParseScalar(absl::string_view name) {
  constexpr std::pair<absl::string_view, Scalar> kNames[] = {
      {"char", Scalar::kInt8},      {"int8", Scalar::kInt8},       {"uchar", Scalar::kUint8},
      {"uint8", Scalar::kUint8},    {"short", Scalar::kInt16},     {"int16", Scalar::kInt16},
      {"ushort", Scalar::kUint16},  {"uint16", Scalar::kUint16},   {"int", Scalar::kInt32},
      {"int32", Scalar::kInt32},    {"uint", Scalar::kUint32},     {"uint32", Scalar::kUint32},
      {"float", Scalar::kFloat32},  {"float32", Scalar::kFloat32}, {"double", Scalar::kFloat64},
      {"float64", Scalar::kFloat64}};
  for (const auto& [text, scalar] : kNames) {
    if (text == name) return scalar;
  }
  return std::nullopt;
}

absl::Status ParseHeaderLine(absl::string_view line, Header& header) {
  const std::vector<absl::string_view> words = absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
  if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return absl::OkStatus();
  if (words[0] == "format" && words.size() >= 2) {
    if (words[1] == "ascii")
      header.format = Format::kAscii;
    else if (words[1] == "binary_little_endian")
      header.format = Format::kLittleEndian;
    else if (words[1] == "binary_big_endian")
      header.format = Format::kBigEndian;
    else
      return Bad("PLY header: format \"", words[1], "\" is unknown");
    return absl::OkStatus();
  }
  if (words[0] == "element" && words.size() == 3) {
    Element element;
    element.name = std::string(words[1]);
    if (!absl::SimpleAtoi(words[2], &element.count)) return Bad("PLY header: \"", line, "\" has no valid count");
    header.elements.push_back(std::move(element));
    return absl::OkStatus();
  }
  if (words[0] == "property" && !header.elements.empty()) {
    const bool list = words.size() == 5 && words[1] == "list";
    if (list || words.size() == 3) {
      const auto count_type = list ? ParseScalar(words[2]) : std::nullopt;
      const auto type = ParseScalar(words[list ? 3 : 1]);
      if (!type || (list && !count_type)) return Bad("PLY header: \"", line, "\" has an unknown type");
      header.elements.back().properties.push_back({std::string(words.back()), *type, count_type});
      return absl::OkStatus();
    }
  }
  return Bad("PLY header: \"", line.substr(0, 80), "\" is not understood");
}

// Takes the header off the front of `rest`.
absl::StatusOr<Header> TakeHeader(absl::string_view& rest) {
  Header header;
  for (bool first = true;; first = false) {
    const size_t end = rest.find('\n');
    if (end == absl::string_view::npos) return Bad(first ? "not a PLY file" : "PLY header: end_header is missing");
    absl::string_view line = rest.substr(0, end);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    rest.remove_prefix(end + 1);
    if (first && line != "ply") return Bad("not a PLY file");
    if (line == "end_header") return header;
    if (first) continue;
    if (auto status = ParseHeaderLine(line, header); !status.ok()) return status;
  }
}

// The numbers after the header, one after the other. After an end or an unreadable number, `ok` is false for good.
class Body {
 public:
  Body(absl::string_view rest, Format format) : rest_(rest), format_(format) {}

  bool ok() const { return ok_; }

  double TakeNumber(Scalar type) {
    if (format_ == Format::kAscii) return TakeText<double>();
    switch (type) {
      case Scalar::kInt8:
        return TakeBinary<int8_t>();
      case Scalar::kUint8:
        return TakeBinary<uint8_t>();
      case Scalar::kInt16:
        return TakeBinary<int16_t>();
      case Scalar::kUint16:
        return TakeBinary<uint16_t>();
      case Scalar::kInt32:
        return TakeBinary<int32_t>();
      case Scalar::kUint32:
        return TakeBinary<uint32_t>();
      case Scalar::kFloat32:
        return TakeBinary<float>();
      case Scalar::kFloat64:
        return TakeBinary<double>();
    }
    return 0;
  }

  // Rounded once: decimal text goes to float32 directly, not by way of double.
  float TakeFloat(Scalar type) {
    return format_ == Format::kAscii ? TakeText<float>() : static_cast<float>(TakeNumber(type));
  }

 private:
  template <class T>
  T TakeBinary() {
    if (!ok_ || rest_.size() < sizeof(T)) return ok_ = false, T{};
    char bytes[sizeof(T)];
    std::memcpy(bytes, rest_.data(), sizeof(T));
    rest_.remove_prefix(sizeof(T));
    if (format_ == Format::kBigEndian) std::reverse(bytes, bytes + sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }

  template <class T>
  T TakeText() {
    const size_t begin = std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size());
    const size_t end = std::min(rest_.find_first_of(" \t\r\n", begin), rest_.size());
    absl::string_view word = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    if (!word.empty() && word[0] == '+') word.remove_prefix(1);
    T value{};
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error == std::errc::result_out_of_range) value = FromText<T>(std::string(word));
    ok_ = ok_ && !word.empty() && stop == word.data() + word.size() && error != std::errc::invalid_argument;
    return value;
  }

  // For what overflows or underflows, of which from_chars has no value.
  template <class T>
  static T FromText(const std::string& word) {
    return static_cast<T>(sizeof(T) == sizeof(float) ? std::strtof(word.c_str(), nullptr)
                                                     : std::strtod(word.c_str(), nullptr));
  }

  absl::string_view rest_;
  Format format_;
  bool ok_ = true;
};

absl::Status EndsEarly(const Element& element, uint64_t at) {
  return Bad("ends or is damaged at ", element.name, " ", at, " of ", element.count);
}

void SkipProperty(const Property& property, Body& body) {
  double count = property.count_type ? body.TakeNumber(*property.count_type) : 1;
  for (; body.ok() && count >= 1; --count) body.TakeNumber(property.type);
}

// Which of the names a single number of a vertex has.
std::optional<size_t> PlaceOf(const Property& property, const std::array<const char*, 3>& names) {
  const auto found = std::find(names.begin(), names.end(), property.name);
  if (property.count_type || found == names.end()) return std::nullopt;
  return static_cast<size_t>(found - names.begin());
}

constexpr std::array<const char*, 3> kAxes{"x", "y", "z"}, kColors{"red", "green", "blue"};

// The first of the names that no single number of a vertex has, of that type if there is one; null if all are there.
const char* Missing(const Element& element, const std::array<const char*, 3>& names, std::optional<Scalar> type) {
  for (const char* name : names) {
    const auto is = [&](const Property& property) {
      return property.name == name && !property.count_type && property.type == type.value_or(property.type);
    };
    if (std::none_of(element.properties.begin(), element.properties.end(), is)) return name;
  }
  return nullptr;
}

absl::Status ReadVertices(const Element& element, Body& body, Mesh& mesh) {
  if (const char* axis = Missing(element, kAxes, std::nullopt)) {
    return Bad("PLY header: element vertex has no property ", axis);
  }
  const bool has_colors = Missing(element, kColors, Scalar::kUint8) == nullptr;
  for (uint64_t n = 0; n < element.count; ++n) {
    Vec3f position{};
    Color color{};
    for (const Property& property : element.properties) {
      if (const auto axis = PlaceOf(property, kAxes)) {
        position[*axis] = body.TakeFloat(property.type);
      } else if (const auto part = PlaceOf(property, kColors); part && has_colors) {
        color[*part] = static_cast<uint8_t>(std::min(std::max(0.0, body.TakeNumber(property.type)), 255.0));
      } else {
        SkipProperty(property, body);
      }
    }
    if (!body.ok()) return EndsEarly(element, n);
    for (const float coordinate : position) {
      if (!std::isfinite(coordinate)) return Bad("vertex ", n, " is not finite (", coordinate, ")");
    }
    mesh.positions.push_back(position);
    if (has_colors) mesh.colors.push_back(color);
  }
  return absl::OkStatus();
}

bool IsCorners(const Property& property) {
  return property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index");
}

// The corners of face n.
absl::Status TakeCorners(const Property& property, uint64_t n, size_t vertices, Body& body,
                         std::vector<uint32_t>& corners) {
  corners.clear();
  for (double count = body.TakeNumber(*property.count_type); body.ok() && count >= 1; --count) {
    const double index = body.TakeNumber(property.type);
    if (!body.ok()) break;
    if (!(index >= 0 && index < static_cast<double>(vertices)) || index != std::floor(index)) {
      return Bad("vertex index ", index, " of face ", n, " is not within the ", vertices, " vertices");
    }
    corners.push_back(static_cast<uint32_t>(index));
  }
  return absl::OkStatus();
}

absl::Status ReadFaces(const Element& element, Body& body, Mesh& mesh) {
  if (std::none_of(element.properties.begin(), element.properties.end(), IsCorners)) {
    return Bad("PLY header: element face has no list vertex_indices");
  }
  std::vector<uint32_t> corners;
  for (uint64_t n = 0; n < element.count; ++n) {
    for (const Property& property : element.properties) {
      if (!IsCorners(property)) {
        SkipProperty(property, body);
      } else if (auto status = TakeCorners(property, n, mesh.positions.size(), body, corners); !status.ok()) {
        return status;
      }
    }
    if (!body.ok()) return EndsEarly(element, n);
    if (corners.size() < 3) {
      ++mesh.skipped;
    } else {
      Triangulate(corners, mesh.positions, mesh.triangles);
    }
  }
  return absl::OkStatus();
}

absl::Status SkipElement(const Element& element, Body& body) {
  if (element.properties.empty()) return absl::OkStatus();
  for (uint64_t n = 0; n < element.count; ++n) {
    for (const Property& property : element.properties) SkipProperty(property, body);
    if (!body.ok()) return EndsEarly(element, n);
  }
  return absl::OkStatus();
}

}  // namespace

// Nothing is allocated by a declared count: vectors grow with the bytes that are there.
absl::StatusOr<Mesh> ParsePly(absl::string_view bytes) {
  const absl::StatusOr<Header> header = TakeHeader(bytes);
  if (!header.ok()) return header.status();
  Body body(bytes, header->format);
  Mesh mesh;
  for (const Element& element : header->elements) {
    absl::Status status = element.name == "vertex" ? ReadVertices(element, body, mesh)
                          : element.name == "face" ? ReadFaces(element, body, mesh)
                                                   : SkipElement(element, body);
    if (!status.ok()) return status;
  }
  return mesh;
}

}  // namespace latvox::client
