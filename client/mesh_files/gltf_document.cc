#include "client/mesh_files/gltf_document.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/mesh_files/bad.h"

namespace latvox::client {
namespace {

constexpr uint64_t kMostExact = uint64_t{1} << 53;  // limit of exact integers in JSON libraries

// The JSON and the binary chunk of a file.
struct Chunks {
  absl::string_view json, binary;
};

// A .glb is a header of 12 bytes and chunks. A chunk has its length, its kind and its bytes.
absl::StatusOr<Chunks> SplitChunks(absl::string_view bytes) {
  if (!absl::StartsWith(bytes, "glTF")) return Chunks{bytes, {}};
  uint32_t version = 2;
  if (bytes.size() >= 8) std::memcpy(&version, bytes.data() + 4, sizeof(version));
  if (version != 2) return Bad("version ", version, " of the container is not 2");
  Chunks chunks;
  size_t at = 12;
  for (absl::string_view* chunk : {&chunks.json, &chunks.binary}) {
    if (chunk == &chunks.binary && at == bytes.size()) break;
    uint32_t length = 0;
    if (at + 8 > bytes.size()) return Bad("ends at byte ", bytes.size(), ", within a chunk's header");
    std::memcpy(&length, bytes.data() + at, sizeof(length));
    at += 8;
    if (length > bytes.size() - at) {
      return Bad("ends at byte ", bytes.size(), ", within a chunk of ", length, " bytes from ", at, " on");
    }
    const bool known = chunk == &chunks.json || bytes.substr(at - 4, 4) == absl::string_view("BIN\0", 4);
    if (known) *chunk = bytes.substr(at, length);
    at += length;
  }
  return chunks;
}

// Returns whether an extension leaves the positions of triangles alone, because it describes only appearance or
// meaning.
bool LeavesTrianglesAlone(absl::string_view extension) {
  constexpr absl::string_view kBeginnings[] = {"KHR_materials_",
                                               "EXT_materials_",
                                               "ADOBE_materials_",
                                               "KHR_texture_",
                                               "EXT_texture_",
                                               "MSFT_texture_",
                                               "MSFT_packing_",
                                               "KHR_lights_",
                                               "EXT_lights_",
                                               "KHR_technique",  // and its draft, without the s
                                               "KHR_xmp",
                                               "KHR_animation_pointer",
                                               "EXT_mesh_features",
                                               "EXT_structural_metadata",
                                               "EXT_instance_features",
                                               "EXT_feature_metadata",
                                               "EXT_image_",
                                               "CESIUM_primitive_outline",
                                               "GOOGLE_",
                                               "VRM",
                                               "VRMC_",
                                               "KHR_audio",
                                               "MOZ_"};
  return std::any_of(std::begin(kBeginnings), std::end(kBeginnings),
                     [&](absl::string_view beginning) { return absl::StartsWith(extension, beginning); });
}

absl::Status CheckVersion(const SortedJson& root) {
  const SortedJson& asset = root.at("asset");
  const auto version = asset.at("version").get<std::string>(), least = asset.value("minVersion", "2.0");
  if (!absl::StartsWith(version, "2.")) return Bad("asset.version \"", version, "\" is not 2.0");
  if (least != "2.0") return Bad("asset.minVersion \"", least, "\" is not 2.0");
  return absl::OkStatus();
}

bool IsRead(absl::string_view extension) {
  constexpr absl::string_view kRead[] = {"KHR_draco_mesh_compression", "KHR_mesh_quantization",
                                         "EXT_mesh_gpu_instancing",    "EXT_meshopt_compression",
                                         "KHR_meshopt_compression",    "CESIUM_RTC"};
  return std::find(std::begin(kRead), std::end(kRead), extension) != std::end(kRead);
}

// Returns whether a file has the same triangles without the extension, if it is not required.
bool HasFallback(absl::string_view extension) { return extension == "MSFT_lod"; }

// Refuses required extensions that may place triangles, and warns of others.
absl::Status CheckExtensions(const SortedJson& root, std::vector<Warning>& warnings) {
  const SortedJson none = SortedJson::array();
  for (const SortedJson& each : root.value("extensionsRequired", none)) {
    const auto name = each.get<std::string>();
    if (!IsRead(name) && !LeavesTrianglesAlone(name)) return Bad("extensionsRequired: ", name, " is not supported");
  }
  for (const SortedJson& each : root.value("extensionsUsed", none)) {
    const auto name = each.get<std::string>();
    if (IsRead(name) || LeavesTrianglesAlone(name) || HasFallback(name)) continue;
    warnings.push_back({"UNKNOWN_EXTENSION",
                        absl::StrCat("extensionsUsed: ", name, " is not read, and may place or change triangles"),
                        name});
  }
  return absl::OkStatus();
}

absl::StatusOr<uint64_t> Whole(const SortedJson& value, const char* name) {
  const double number = value.is_number() ? value.get<double>() : -1;
  if (!(number >= 0 && number <= static_cast<double>(kMostExact)) || number != std::floor(number)) {
    return Bad(name, ": ", value.dump().substr(0, 40), " is not a whole number from 0 to ", kMostExact);
  }
  return static_cast<uint64_t>(number);
}

}  // namespace

absl::Status GltfError(const SortedJson::exception& error) {
  const absl::string_view what = error.what();  // "[json.exception.parse_error.101] parse error at line 2, ..."
  return Bad("JSON: ", what.substr(what.find("] ") + 2));
}

absl::StatusOr<GltfDocument> ParseGltfDocument(absl::string_view bytes) try {
  const auto chunks = SplitChunks(bytes);
  if (!chunks.ok()) return chunks.status();
  GltfDocument document{SortedJson::parse(chunks->json), chunks->binary, {}};
  if (auto status = CheckVersion(document.root); !status.ok()) return status;
  if (auto status = CheckExtensions(document.root, document.warnings); !status.ok()) return status;
  return document;
} catch (const SortedJson::exception& error) {
  return GltfError(error);
}

absl::StatusOr<uint64_t> GltfNumber(const SortedJson& object, const char* name, std::optional<uint64_t> otherwise) {
  const auto found = object.find(name);
  if (found != object.end()) return Whole(*found, name);
  if (!otherwise) return Bad(name, " is missing");
  return *otherwise;
}

absl::StatusOr<uint64_t> GltfElement(const SortedJson& value, const char* name, const SortedJson& root,
                                     const char* list) {
  const auto number = Whole(value, name);
  const auto elements = root.find(list);
  const size_t size = elements == root.end() ? 0 : elements->size();
  if (number.ok() && *number >= size) return Bad(name, " ", *number, " is not among the ", size, " ", list);
  return number;
}

absl::StatusOr<uint64_t> GltfIndex(const SortedJson& object, const char* name, const SortedJson& root, const char* list,
                                   std::optional<uint64_t> otherwise) {
  const auto number = GltfNumber(object, name, otherwise);
  return number.ok() ? GltfElement(*number, name, root, list) : number;
}

}  // namespace latvox::client
