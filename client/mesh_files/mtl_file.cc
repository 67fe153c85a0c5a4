#include "client/mesh_files/mtl_file.h"

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
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

}  // namespace

// Other files than regular ones may never end.
std::optional<std::string> FindFile(absl::string_view name, const std::filesystem::path& folder) {
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

namespace {

// Reads up to three numbers after an option of a texture. Returns how many there are.
size_t ReadOptionNumbers(absl::string_view& words, std::array<double, 3>& numbers) {
  size_t count = 0;
  while (count < numbers.size()) {
    absl::string_view rest = words;
    if (!ParseDouble(TakeWord(rest), numbers[count])) break;
    words = rest;
    ++count;
  }
  return count;
}

// Takes one option and its values off the front of the words. Returns its name if it is not read.
std::string TakeTextureOption(absl::string_view& words, MtlTexture& texture) {
  const absl::string_view option = TakeWord(words);
  std::array<double, 3> numbers{};
  if (option == "-clamp") {
    texture.clamps = TakeWord(words) == "on";
    return "";
  }
  if (option == "-o" || option == "-s") {
    auto& target = option == "-o" ? texture.offset : texture.scale;
    const size_t count = ReadOptionNumbers(words, numbers);
    for (size_t n = 0; n < std::min(count, target.size()); ++n) target[n] = numbers[n];
    return "";
  }
  constexpr absl::string_view kOfWords[] = {"-blendu", "-blendv", "-cc", "-imfchan", "-type", "-colorspace"};
  if (std::find(std::begin(kOfWords), std::end(kOfWords), option) != std::end(kOfWords)) {
    TakeWord(words);
  } else {
    ReadOptionNumbers(words, numbers);
  }
  const bool is_filter = option == "-blendu" || option == "-blendv";  // which has no effect on a mean
  return is_filter ? "" : std::string(option);
}

// Reads the words after `map_Kd`: options, then the name of a file, which may have spaces.
void ReadTexture(absl::string_view words, const std::filesystem::path& folder, const std::string& material,
                 MtlMaterials& materials, std::vector<Warning>& warnings) {
  MtlTexture texture;
  texture.folder = folder;
  for (words = absl::StripAsciiWhitespace(words); absl::StartsWith(words, "-");
       words = absl::StripAsciiWhitespace(words)) {
    const std::string unread = TakeTextureOption(words, texture);
    if (unread.empty()) continue;
    warnings.push_back(
        {"IGNORED_TEXTURE",
         absl::StrCat("the texture of material \"", material, "\" has the option ", unread, ", which is not read"),
         absl::StrCat("material ", material)});
  }
  texture.name = std::string(words);
  materials.textures[material] = std::move(texture);
}

void ReadMaterialFile(const std::string& path, MtlMaterials& materials, std::vector<Warning>& warnings) {
  auto bytes = ReadBytes(path);
  if (bytes.ok()) bytes = Decode(*std::move(bytes), warnings);
  if (bytes.ok()) {
    ParseMtl(*bytes, std::filesystem::path(path).parent_path(), materials, warnings);
  } else {
    warnings.push_back({"MISSING_FILE", std::string(bytes.status().message()), path});
  }
}

}  // namespace

void ParseMtl(absl::string_view text, const std::filesystem::path& folder, MtlMaterials& materials,
              std::vector<Warning>& warnings) {
  ObjStatements statements(text);
  std::string material;
  std::vector<std::string> colored;  // the materials of `numbers`
  ColorNumbers numbers;
  for (absl::string_view words; statements.Next(words);) {
    const absl::string_view keyword = TakeWord(words);
    if (keyword == "newmtl") material = std::string(absl::StripAsciiWhitespace(words));
    if (keyword == "map_Kd") ReadTexture(words, folder, material, materials, warnings);
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
  for (size_t n = 0; n < colored.size(); ++n) materials.colors[colored[n]] = (*bytes)[n];
}

void ReadMaterials(absl::string_view names, size_t line, const std::filesystem::path& folder, MtlMaterials& materials,
                   std::vector<Warning>& warnings) {
  if (const auto path = FindFile(names, folder))
    return ReadMaterialFile(*path, materials, warnings);  // its name has spaces
  for (absl::string_view name = TakeWord(names); !name.empty(); name = TakeWord(names)) {
    if (const auto path = FindFile(name, folder)) {
      ReadMaterialFile(*path, materials, warnings);
    } else {
      warnings.push_back({"MISSING_FILE", absl::StrCat("line ", line, ": material file \"", name, "\" does not exist"),
                          NameOfLine(line)});
    }
  }
}

}  // namespace latvox::client
