#include "client/tool/inspect/image_facts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "client/tool/inspect/byte_source.h"
#include "client/tool/inspect/inflated_source.h"
#include "latvox/fields.h"

namespace latvox::client {
namespace {

struct ImageHead {
  std::string type;  // as numpy calls it
  std::array<uint64_t, 3> shape{};
  uint64_t components = 1;
  bool planar = false;            // all elements of one component come before those of the next
  std::array<double, 9> basis{};  // steps along i, then j, then k
  std::array<double, 3> corner{};
};

size_t BytesOfType(const std::string& type) { return type == "uint8" ? 1 : type == "uint16" ? 2 : 4; }

// Returns whether an element is a voxel, as far as its first component tells.
bool IsVoxel(const std::string& type, const char* element) {
  float number = 0;
  int32_t label = 0;
  if (type == "uint8") return *element != 0;
  std::memcpy(&number, element, 4);
  std::memcpy(&label, element, 4);
  return type == "int32" ? label != 0 : !std::isnan(number);
}

// Reads the elements.
absl::StatusOr<Json> Facts(const ImageHead& head, ByteSource& data) {
  constexpr uint64_t kMost = uint64_t{1} << 40;
  uint64_t elements = 1;
  for (const uint64_t side : head.shape) {
    if (side == 0 || side > kMost || elements > kMost / side) return data.Bad("has a shape that is not read");
    elements *= side;
  }
  constexpr uint64_t kMostComponents = 1 + kMostFractionLabels;  // of 16 bits; there are fewer fields of other types
  if (head.components == 0 || head.components > kMostComponents) {
    return data.Bad("has ", head.components, " components, not 1 to ", kMostComponents);
  }
  const size_t bytes = BytesOfType(head.type);
  const size_t step = head.planar ? bytes : bytes * head.components;
  uint64_t voxels = 0;
  std::string piece(step * 4096, '\0');
  for (uint64_t plane = 0; plane < (head.planar ? head.components : 1); ++plane) {
    for (uint64_t left = elements; left > 0;) {
      const size_t count = std::min<uint64_t>(left, 4096);
      if (auto status = data.Read(piece.data(), count * step); !status.ok()) return status;
      for (size_t n = 0; n < count && plane == 0; ++n)
        voxels += head.type != "uint16" && IsVoxel(head.type, &piece[n * step]);
      left -= count;
    }
  }
  if (auto status = data.CheckEnd(); !status.ok()) return status;
  Json facts = {{"type", head.type},
                {"shape", head.shape},
                {"components", head.components},
                {"basis", head.basis},
                {"corner", head.corner}};
  const bool is_color = head.type == "uint8" && head.components == 3;
  if (head.type != "uint16" && !is_color) facts["voxels"] = voxels;
  return facts;
}

// Reads numbers with a separator between them. Returns false if there are others than N.
template <class T, size_t N>
bool ReadLineOfNumbers(absl::string_view text, std::array<T, N>& numbers) {
  const std::vector<absl::string_view> words = absl::StrSplit(text, absl::ByAnyChar(" ,()"), absl::SkipEmpty());
  if (words.size() != N) return false;
  for (size_t n = 0; n < N; ++n) {
    if constexpr (std::is_floating_point_v<T>) {
      if (!absl::SimpleAtod(words[n], &numbers[n])) return false;
    } else if (!absl::SimpleAtoi(words[n], &numbers[n])) {
      return false;
    }
  }
  return true;
}

// Reads lines "name: value" up to one that is empty, or up to and with the one named `last`.
absl::StatusOr<std::map<std::string, std::string>> ReadFields(FileSource& file, const char* separator,
                                                              const std::string& last) {
  constexpr size_t kMostLines = 64;
  constexpr size_t kMostKeys = 1 << 20;
  std::map<std::string, std::string> fields;
  std::string line;
  size_t keys = 0;
  for (size_t n = 0; n < kMostLines; ++n) {
    const auto more = file.ReadLine(line);
    if (!more.ok()) return more.status();
    if (!*more) return file.Bad("is cut short");
    if (line.empty()) return fields;
    if (absl::StrContains(line, ":=") && keys++ < kMostKeys) {  // of a .nrrd: names of labels
      --n;
      continue;
    }
    const std::pair<std::string, std::string> field = absl::StrSplit(line, absl::MaxSplits(separator, 1));
    fields.insert(field);
    if (field.first == last) return fields;
  }
  return file.Bad("has more than ", kMostLines, " lines before its data");
}

// Returns a type's name, given those of the format in the order uint8, uint16, int32, float32. "": none of them.
std::string TypeOf(const std::array<std::string, 4>& names, const std::string& name) {
  constexpr const char* kTypes[] = {"uint8", "uint16", "int32", "float32"};
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? "" : kTypes[found - names.begin()];
}

template <class T>
T At(const std::string& bytes, size_t at) {
  T value;
  std::memcpy(&value, &bytes[at], sizeof(T));
  return value;
}

// Returns nothing for a form that latvox does not write.
template <class Side, class Real>
std::optional<ImageHead> NiftiHead(const std::string& bytes, const std::array<Side, 8>& sides, int16_t type,
                                   size_t rows_at) {
  constexpr int16_t kRgb24 = 128;
  const bool is_rgb = type == kRgb24;
  ImageHead head;
  head.type = TypeOf({"2", "512", "8", "16"}, is_rgb ? "2" : absl::StrCat(type));
  const bool good = !head.type.empty() && (sides[0] == 3 || sides[0] == 5) && sides[4] == 1 &&
                    *std::min_element(sides.begin(), sides.begin() + 6) > 0;
  if (!good) return std::nullopt;
  head.planar = sides[0] == 5;
  head.components = is_rgb ? 3 : head.planar ? static_cast<uint64_t>(sides[5]) : 1;
  for (size_t n = 0; n < 3; ++n) {
    head.shape[n] = static_cast<uint64_t>(sides[n + 1]);
    const auto row = At<std::array<Real, 4>>(bytes, rows_at + n * 4 * sizeof(Real));
    for (size_t m = 0; m < 3; ++m) head.basis[3 * m + n] = row[m];
    head.corner[n] = row[3];
  }
  return head;
}

std::optional<ImageHead> Nifti1Head(const std::string& bytes) {
  const bool good = At<int32_t>(bytes, 0) == 348 && absl::string_view(bytes).substr(344, 3) == "n+1" &&
                    At<float>(bytes, 108) == static_cast<float>(bytes.size());
  if (!good) return std::nullopt;
  return NiftiHead<int16_t, float>(bytes, At<std::array<int16_t, 8>>(bytes, 40), At<int16_t>(bytes, 70), 280);
}

std::optional<ImageHead> Nifti2Head(const std::string& bytes) {
  const bool good =
      absl::string_view(bytes).substr(4, 3) == "n+2" && At<int64_t>(bytes, 168) == static_cast<int64_t>(bytes.size());
  if (!good) return std::nullopt;
  return NiftiHead<int64_t, double>(bytes, At<std::array<int64_t, 8>>(bytes, 16), At<int16_t>(bytes, 12), 400);
}

}  // namespace

absl::StatusOr<Json> NrrdFacts(const std::string& path) {
  const auto file = FileSource::Open(path);
  if (!file.ok()) return file.status();
  auto fields = ReadFields(**file, ": ", "");
  if (!fields.ok()) return fields.status();
  ImageHead head;
  head.type = TypeOf({"uint8", "uint16", "int32", "float"}, (*fields)["type"]);
  std::array<uint64_t, 4> all{};
  bool good = fields->contains("NRRD0005") && !head.type.empty() && (*fields)["encoding"] == "gzip";
  if ((*fields)["dimension"] == "4") {
    good = good && ReadLineOfNumbers((*fields)["sizes"], all);
    head.components = all[0];
    std::copy(all.begin() + 1, all.end(), head.shape.begin());
  } else {
    good = good && ReadLineOfNumbers((*fields)["sizes"], head.shape);
  }
  const std::string directions = absl::StrReplaceAll((*fields)["space directions"], {{"none", ""}});
  good = good && ReadLineOfNumbers(directions, head.basis) && ReadLineOfNumbers((*fields)["space origin"], head.corner);
  if (!good) return (*file)->Bad("is not a .nrrd of latvox");
  InflatedSource data(path, **file);
  return Facts(head, data);
}

absl::StatusOr<Json> MetaImageFacts(const std::string& path) {
  const auto file = FileSource::Open(path);
  if (!file.ok()) return file.status();
  auto fields = ReadFields(**file, " = ", "ElementDataFile");
  if (!fields.ok()) return fields.status();
  ImageHead head;
  head.type = TypeOf({"MET_UCHAR", "MET_USHORT", "MET_INT", "MET_FLOAT"}, (*fields)["ElementType"]);
  std::array<double, 9> directions{};
  std::array<double, 3> spacing{};
  const bool good =
      (*fields)["ObjectType"] == "Image" && !head.type.empty() && ReadLineOfNumbers((*fields)["DimSize"], head.shape) &&
      absl::SimpleAtoi((*fields)["ElementNumberOfChannels"], &head.components) &&
      ReadLineOfNumbers((*fields)["TransformMatrix"], directions) &&
      ReadLineOfNumbers((*fields)["ElementSpacing"], spacing) && ReadLineOfNumbers((*fields)["Offset"], head.corner);
  if (!good) return (*file)->Bad("is not a MetaImage of latvox");
  for (size_t n = 0; n < 9; ++n) head.basis[n] = directions[n] * spacing[n / 3];
  const std::string data_file = (*fields)["ElementDataFile"];
  if (data_file == "LOCAL") {
    InflatedSource data(path, **file);
    return Facts(head, data);
  }
  if (auto status = (*file)->CheckEnd(); !status.ok()) return status;
  // Only a file beside it: a foreign header must not make us read others.
  if (absl::StrContains(data_file, '/') || data_file.empty()) {
    return (*file)->Bad("names the data ", data_file, ", which is not a file beside it");
  }
  const auto data = FileSource::Open(std::filesystem::path(path).replace_filename(data_file).string());
  if (!data.ok()) return data.status();
  return Facts(head, **data);
}

absl::StatusOr<Json> NiftiFacts(const std::string& path) {
  const auto file = FileSource::Open(path);
  if (!file.ok()) return file.status();
  std::optional<InflatedSource> inflated;
  if (absl::EndsWithIgnoreCase(path, ".gz")) inflated.emplace(path, **file);
  ByteSource& source = inflated ? static_cast<ByteSource&>(*inflated) : **file;
  constexpr size_t kBytes1 = 352, kBytes2 = 544;
  std::string bytes(kBytes1, '\0');
  if (auto status = source.Read(bytes.data(), kBytes1); !status.ok()) return status;
  const bool is_second = At<int32_t>(bytes, 0) == 540;
  if (is_second) {
    bytes.resize(kBytes2);
    if (auto status = source.Read(&bytes[kBytes1], kBytes2 - kBytes1); !status.ok()) return status;
  }
  auto head = is_second ? Nifti2Head(bytes) : Nifti1Head(bytes);
  if (!head) return source.Bad("is not a NIfTI of latvox");
  return Facts(*head, source);
}

}  // namespace latvox::client
