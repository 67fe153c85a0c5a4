#include "client/tool/inspect/file_facts.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "client/json/warning_json.h"
#include "client/mesh_files/mesh_file.h"
#include "client/mesh_files/mesh_format.h"
#include "client/tool/inspect/array_facts.h"
#include "client/tool/inspect/box_facts.h"
#include "client/tool/inspect/extent.h"
#include "client/tool/inspect/image_facts.h"
#include "client/tool/inspect/picture_facts.h"
#include "client/tool/inspect/table_facts.h"
#include "client/tool/inspect/vtk_facts.h"

namespace latvox::client {
namespace {

// Describes the colors at the corners of triangles, so it does not matter how often a vertex is written.
struct ColorFacts {
  explicit ColorFacts(const Mesh& mesh) {
    if (mesh.colors.size() != mesh.positions.size() || mesh.triangles.empty()) return;
    Extent<uint8_t> extent;
    std::array<uint64_t, 3> sums{};
    for (const auto& triangle : mesh.triangles) {
      for (const uint32_t vertex : triangle) {
        const Color& color = mesh.colors[vertex];
        extent.Add(color);
        for (size_t n = 0; n < 3; ++n) sums[n] += color[n];
      }
    }
    range = extent.ToJson();
    mean = Json::array();
    for (const uint64_t sum : sums) {
      mean.push_back(static_cast<double>(sum) / static_cast<double>(3 * mesh.triangles.size()));
    }
  }

  Json range, mean;  // of sRGB bytes; null without colors
};

absl::StatusOr<Json> FactsOfMesh(const std::string& path) {
  const auto mesh = ReadMesh(path);
  if (!mesh.ok()) return mesh.status();
  Extent<double> bounds;
  for (const auto& triangle : mesh->triangles) {
    for (const uint32_t vertex : triangle) bounds.Add(mesh->positions[vertex]);
  }
  const ColorFacts colors(*mesh);
  const uint32_t parts = mesh->stretches.empty() ? 1 : mesh->stretches.back().part + 1;
  return Json{{"triangles", mesh->triangles.size()},
              {"vertices", mesh->positions.size()},
              {"parts", parts},
              {"part_names", mesh->part_names},
              {"materials", mesh->materials},
              {"material_names", mesh->material_names},
              {"colors", colors.range},
              {"mean_color", colors.mean},
              {"bounds", bounds.ToJson()},
              {"warnings", WarningsJson(mesh->warnings)}};
}

// The content of these formats tells whether it is voxels or a mesh.
template <absl::StatusOr<std::optional<Json>> (*of_voxels)(FileSource&)>
absl::StatusOr<Json> VoxelsOrMesh(const std::string& path) {
  const auto file = FileSource::Open(path);
  if (!file.ok()) return file.status();
  auto facts = of_voxels(**file);
  if (!facts.ok()) return facts.status();
  return *facts ? **std::move(facts) : FactsOfMesh(path);
}

template <absl::StatusOr<Json> (*of_file)(FileSource&)>
absl::StatusOr<Json> Opened(const std::string& path) {
  const auto file = FileSource::Open(path);
  if (!file.ok()) return file.status();
  return of_file(**file);
}

constexpr char kNiiGz[] = ".nii.gz";

constexpr std::pair<absl::string_view, absl::StatusOr<Json> (*)(const std::string&)> kFormats[] = {
    {".csv", Opened<CsvFacts>},
    {".npy", Opened<NpyFacts>},
    {".npz", NpzFacts},
    {".ply", VoxelsOrMesh<PlyFacts>},
    {".glb", VoxelsOrMesh<SurfaceFacts>},
    {".vox", Opened<VoxFacts>},
    {".binvox", Opened<BinvoxFacts>},
    {".png", Opened<PngFacts>},
    {".html", Opened<PageFacts>},
    {".vti", Opened<VtiFacts>},
    {".vtu", Opened<VtuFacts>},
    {".nrrd", NrrdFacts},
    {".mha", MetaImageFacts},
    {".mhd", MetaImageFacts},
    {".nii", NiftiFacts},
    {kNiiGz, NiftiFacts},
    {".obj", FactsOfMesh},
    {".stl", FactsOfMesh},
    {".off", FactsOfMesh},
    {".gltf", FactsOfMesh},
    {".3mf", FactsOfMesh},
    {".drc", FactsOfMesh},
};

std::string Show(const Json& value) {
  if (value.is_null() || value.empty()) return "none";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return absl::StrFormat("%.9g", value.get<double>());
  if (!value.is_structured()) return value.dump();
  if (value.contains("message")) return value["message"].get<std::string>();
  std::vector<std::string> words;
  for (const Json& each : value) words.push_back(Show(each));
  return absl::StrJoin(words, value.is_array() && !value.empty() && value[0].is_structured() ? "; " : ",");
}

// Returns lines "name  value", and for objects within the facts a line for each member.
std::string ToText(const Json& facts) {
  std::string text;
  for (const auto& [name, value] : facts.items()) {
    const std::string label = absl::StrReplaceAll(name, {{"_", " "}});
    if (value.is_object() && value.contains("min")) {
      absl::StrAppendFormat(&text, "%-15s%s to %s%s\n", label, Show(value["min"]), name == "index_box" ? "below " : "",
                            Show(value["max"]));
    } else if (value.is_object()) {
      for (const auto& [member, each] : value.items()) absl::StrAppend(&text, member, " = ", Show(each), "\n");
    } else {
      absl::StrAppendFormat(&text, "%-15s%s\n", label, Show(value));
    }
  }
  return text;
}

}  // namespace

absl::StatusOr<FileFacts> ReadFileFacts(const std::string& path) {
  std::filesystem::path name(path);
  // gzip hides the content of .ply and .glb; latvox writes no such file of voxels.
  const bool packed = FormatOfPath(path) && absl::AsciiStrToLower(name.extension().string()) == ".gz";
  if (packed) name.replace_extension();
  const bool is_nifti = absl::EndsWithIgnoreCase(path, kNiiGz);
  const std::string extension = is_nifti ? kNiiGz : absl::AsciiStrToLower(name.extension().string());
  const auto has_it = [&](const auto& format) { return format.first == extension; };
  const auto format = std::find_if(std::begin(kFormats), std::end(kFormats), has_it);
  if (format == std::end(kFormats)) {
    const auto known = [](std::string* out, const auto& each) { absl::StrAppend(out, each.first); };
    return absl::InvalidArgumentError(absl::StrCat(
        path, ": extension \"", extension, "\" is not one of .vdb .nvdb .h5 ", absl::StrJoin(kFormats, " ", known)));
  }
  const auto found = packed ? FactsOfMesh(path) : format->second(path);
  if (!found.ok()) return found.status();
  std::error_code error;
  Json facts = {{"format", extension.substr(1)}, {"bytes", std::filesystem::file_size(path, error)}};
  facts.update(*found);
  return FileFacts{ToText(facts), facts.dump(2, ' ', false, Json::error_handler_t::replace)};
}

}  // namespace latvox::client
