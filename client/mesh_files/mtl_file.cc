#include "client/mesh_files/mtl_file.h"

#include <algorithm>
#include <optional>
#include <system_error>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/mesh_files/color_numbers.h"
#include "client/mesh_files/decode.h"
#include "client/mesh_files/input.h"
#include "client/mesh_files/number_text.h"
#include "client/mesh_files/obj_statements.h"

namespace latvox::client {
namespace {

// One number is the intensity of all three.
std::optional<ColorNumbers::Numbers> ReadNumbers(absl::string_view words) {
  ColorNumbers::Numbers rgb{};
  if (!ParseDouble(TakeWord(words), rgb[0])) return std::nullopt;
  const absl::string_view green = TakeWord(words);
  if (green.empty()) return ColorNumbers::Numbers{rgb[0], rgb[0], rgb[0]};
  if (!ParseDouble(green, rgb[1]) || !ParseDouble(TakeWord(words), rgb[2])) return std::nullopt;
  return rgb;
}

// Returns the path of the regular file of this name in the folder. Others may never end.
std::optional<std::string> Find(absl::string_view name, const std::filesystem::path& folder) {
  std::string local(absl::StripAsciiWhitespace(name));
  if (local.size() >= 2 && local.front() == '"' && local.back() == '"') local = local.substr(1, local.size() - 2);
  std::error_code error;
  for (const bool from_windows : {false, true}) {
    if (from_windows) std::replace(local.begin(), local.end(), '\\', '/');
    const std::filesystem::path path = folder / local;
    if (std::filesystem::is_regular_file(path, error)) return path.string();
  }
  return std::nullopt;
}

void ReadMaterialFile(const std::string& path, MaterialColors& colors, std::vector<Warning>& warnings) {
  auto bytes = ReadBytes(path);
  if (bytes.ok()) bytes = Decode(*std::move(bytes), warnings);
  if (bytes.ok()) {
    ParseMtl(*bytes, colors, warnings);
  } else {
    warnings.push_back({"MISSING_FILE", std::string(bytes.status().message()), path});
  }
}

}  // namespace

void ParseMtl(absl::string_view text, MaterialColors& colors, std::vector<Warning>& warnings) {
  ObjStatements statements(text);
  std::string material;
  std::vector<std::string> colored;  // the materials of `numbers`
  ColorNumbers numbers;
  bool textured = false;
  for (absl::string_view words; statements.Next(words);) {
    const absl::string_view keyword = TakeWord(words);
    if (keyword == "newmtl") material = std::string(absl::StripAsciiWhitespace(words));
    if (keyword == "map_Kd" && !textured) {
      warnings.push_back({"IGNORED_TEXTURE",
                          absl::StrCat("material \"", material, "\" has a texture, which is not read"),
                          absl::StrCat("material ", material)});
      textured = true;
    }
    if (keyword != "Kd") continue;
    if (const auto rgb = ReadNumbers(words)) {
      colored.push_back(material);
      numbers.Add(*rgb);
    } else {
      warnings.push_back({"IGNORED_COLOR", absl::StrCat("Kd of material \"", material, "\" is not three numbers"),
                          absl::StrCat("material ", material)});
    }
  }
  const auto bytes = numbers.ToBytes("material", 0);
  if (!bytes.ok()) {
    warnings.push_back({"IGNORED_COLOR", std::string(bytes.status().message()), ""});
    return;
  }
  for (size_t n = 0; n < colored.size(); ++n) colors[colored[n]] = (*bytes)[n];
}

void ReadMaterials(absl::string_view names, size_t line, const std::filesystem::path& folder, MaterialColors& colors,
                   std::vector<Warning>& warnings) {
  if (const auto path = Find(names, folder)) return ReadMaterialFile(*path, colors, warnings);  // its name has spaces
  for (absl::string_view name = TakeWord(names); !name.empty(); name = TakeWord(names)) {
    if (const auto path = Find(name, folder)) {
      ReadMaterialFile(*path, colors, warnings);
    } else {
      warnings.push_back({"MISSING_FILE", absl::StrCat("line ", line, ": material file \"", name, "\" does not exist"),
                          NameOfLine(line)});
    }
  }
}

}  // namespace latvox::client
