#include "client/mesh_files/mesh_format.h"

#include <filesystem>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "client/mesh_files/off_header.h"
#include "client/mesh_files/stl_file.h"

namespace latvox::client {
namespace {

bool IsObj(absl::string_view bytes) {
  constexpr size_t kMost = size_t{1} << 16;  // the first vertex may follow comments
  const absl::string_view head = bytes.substr(0, kMost);
  if (absl::StrContains(head, '\0')) return false;
  for (const absl::string_view line : absl::StrSplit(head, absl::ByAnyChar("\r\n"))) {
    const absl::string_view text = absl::StripLeadingAsciiWhitespace(line);
    if (absl::StartsWith(text, "v ") || absl::StartsWith(text, "v\t")) return true;
  }
  return false;
}

}  // namespace

const std::vector<std::pair<std::string, MeshFormat>>& MeshFormats() {
  static const auto* const kFormats = new std::vector<std::pair<std::string, MeshFormat>>{
      {"drc", MeshFormat::kDraco}, {"obj", MeshFormat::kObj},    {"ply", MeshFormat::kPly},
      {"stl", MeshFormat::kStl},   {"off", MeshFormat::kOff},    {"glb", MeshFormat::kGlb},
      {"gltf", MeshFormat::kGltf}, {"3mf", MeshFormat::kThreeMf}};
  return *kFormats;
}

std::optional<MeshFormat> FormatOfPath(const std::string& path) {
  std::filesystem::path name_of_file(path);
  if (absl::AsciiStrToLower(name_of_file.extension().string()) == ".gz") name_of_file.replace_extension();
  const std::string extension = absl::AsciiStrToLower(name_of_file.extension().string());
  for (const auto& [name, format] : MeshFormats()) {
    if (extension == "." + name) return format;
  }
  return std::nullopt;
}

absl::string_view WithoutByteOrderMark(absl::string_view bytes) {
  if (!IsBinaryStl(bytes)) absl::ConsumePrefix(&bytes, "\xEF\xBB\xBF");
  return bytes;
}

std::optional<MeshFormat> FormatOfBytes(absl::string_view bytes) {
  bytes = WithoutByteOrderMark(bytes);
  constexpr std::pair<absl::string_view, MeshFormat> kMagic[] = {{"DRACO", MeshFormat::kDraco},
                                                                 {"ply\n", MeshFormat::kPly},
                                                                 {"ply\r", MeshFormat::kPly},
                                                                 {"glTF", MeshFormat::kGlb},
                                                                 {"PK\x03\x04", MeshFormat::kThreeMf}};
  for (const auto& [magic, format] : kMagic) {
    if (absl::StartsWith(bytes, magic)) return format;
  }
  // Comes before "solid", because headers of binary files often begin with it.
  if (IsBinaryStl(bytes)) return MeshFormat::kStl;
  const absl::string_view text = absl::StripLeadingAsciiWhitespace(bytes.substr(0, 1024));
  if (absl::StartsWith(text, "{")) return MeshFormat::kGltf;
  if (absl::StartsWithIgnoreCase(text, "solid")) return MeshFormat::kStl;
  if (IsOff(bytes)) return MeshFormat::kOff;
  if (IsObj(bytes)) return MeshFormat::kObj;
  return std::nullopt;
}

}  // namespace latvox::client
