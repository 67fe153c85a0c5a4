#include "client/mesh_files/ply_header.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/mesh_files/bad.h"

namespace latvox::client {
namespace {

constexpr std::pair<absl::string_view, PlyScalar> kNames[] = {
    {"char", PlyScalar::kInt8},      {"int8", PlyScalar::kInt8},       {"uchar", PlyScalar::kUint8},
    {"uint8", PlyScalar::kUint8},    {"short", PlyScalar::kInt16},     {"int16", PlyScalar::kInt16},
    {"ushort", PlyScalar::kUint16},  {"uint16", PlyScalar::kUint16},   {"int", PlyScalar::kInt32},
    {"int32", PlyScalar::kInt32},    {"uint", PlyScalar::kUint32},     {"uint32", PlyScalar::kUint32},
    {"float", PlyScalar::kFloat32},  {"float32", PlyScalar::kFloat32}, {"double", PlyScalar::kFloat64},
    {"float64", PlyScalar::kFloat64}};

std::optional<PlyScalar> ParseScalar(absl::string_view name) {
  for (const auto& [text, scalar] : kNames) {
    if (text == name) return scalar;
  }
  return std::nullopt;
}

absl::Status ParseHeaderLine(absl::string_view line, PlyHeader& header) {
  const std::vector<absl::string_view> words = absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
  if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return absl::OkStatus();
  if (words[0] == "format" && words.size() >= 2) {
    if (words[1] == "ascii")
      header.format = PlyFormat::kAscii;
    else if (words[1] == "binary_little_endian")
      header.format = PlyFormat::kLittleEndian;
    else if (words[1] == "binary_big_endian")
      header.format = PlyFormat::kBigEndian;
    else
      return Bad("PLY header: format \"", words[1], "\" is unknown");
    return absl::OkStatus();
  }
  if (words[0] == "element" && words.size() == 3) {
    PlyElement element;
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
  if (words[0] == "format" || words[0] == "element" || words[0] == "property") {
    return Bad("PLY header: \"", line.substr(0, 80), "\" is not understood");
  }
  if (header.unmarked.empty()) header.unmarked = std::string(line.substr(0, 80));
  return absl::OkStatus();
}

}  // namespace

std::optional<size_t> PositionOf(const PlyProperty& property, const PlyNames& names) {
  const auto found = std::find(names.begin(), names.end(), property.name);
  if (property.count_type || found == names.end()) return std::nullopt;
  return static_cast<size_t>(found - names.begin());
}

const char* Missing(const PlyElement& element, const PlyNames& names) {
  for (const char* name : names) {
    const auto is = [&](const PlyProperty& property) { return property.name == name && !property.count_type; };
    if (std::none_of(element.properties.begin(), element.properties.end(), is)) return name;
  }
  return nullptr;
}

absl::string_view NameOf(PlyScalar scalar) {
  for (const auto& [text, named] : kNames) {
    if (named == scalar) return text;
  }
  return "";
}

// Takes the next line off the front of `rest`. Returns nothing if no line end follows. A file whose first line ends in
// CR alone ends all lines so: then LF after "end_header" belongs to binary data.
static std::optional<absl::string_view> TakeHeaderLine(absl::string_view& rest, PlyHeader& header) {
  const size_t end = rest.find_first_of("\r\n");
  if (end == absl::string_view::npos) return std::nullopt;
  const absl::string_view line = rest.substr(0, end);
  const bool crlf = absl::StartsWith(rest.substr(end), "\r\n");
  if (header.lines++ == 0) header.ends_in_cr = rest[end] == '\r' && !crlf;
  rest.remove_prefix(end + (crlf && !header.ends_in_cr ? 2 : 1));
  return absl::StripTrailingAsciiWhitespace(line);
}

absl::StatusOr<PlyHeader> ReadPlyHeader(absl::string_view& rest) {
  PlyHeader header;
  for (bool first = true;; first = false) {
    const auto line = TakeHeaderLine(rest, header);
    if (!line) return Bad(first ? "not a PLY file" : "PLY header: end_header is missing");
    if (first && *line != "ply") return Bad("not a PLY file");
    if (*line == "end_header") return header;
    if (first) continue;
    if (auto status = ParseHeaderLine(*line, header); !status.ok()) return status;
  }
}

}  // namespace latvox::client
