#include "client/mesh_files/gltf_meshopt.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/gltf_document.h"

namespace latvox::client {
namespace {

constexpr absl::string_view kMeshoptNames[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};
constexpr absl::string_view kMeshoptModes[] = {"ATTRIBUTES", "TRIANGLES", "INDICES"};
constexpr absl::string_view kMeshoptFilters[] = {"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"};
constexpr uint64_t kMostMeshoptStride = 256;  // limit of the specification

enum class MeshoptMode { kAttributes, kTriangles, kIndices };
enum class MeshoptFilter { kUnfiltered, kOctahedral, kQuaternion, kExponential };

struct MeshoptLayout {
  MeshoptMode mode = MeshoptMode::kAttributes;
  MeshoptFilter filter = MeshoptFilter::kUnfiltered;
  uint64_t count = 0, stride = 0;
};

template <class Value, size_t kSize>
absl::StatusOr<Value> OneOf(const absl::string_view (&words)[kSize], const char* field, const std::string& word) {
  const auto found = std::find(std::begin(words), std::end(words), word);
  if (found == std::end(words)) return Bad(field, " \"", word, "\" is not one of ", absl::StrJoin(words, ", "));
  return static_cast<Value>(found - std::begin(words));
}

// Returns what is wrong with the stride, or nothing.
std::optional<std::string> WrongStride(const MeshoptLayout& layout) {
  const uint64_t stride = layout.stride;
  if (layout.mode != MeshoptMode::kAttributes) {
    if (stride == 2 || stride == 4) return std::nullopt;
    return absl::StrCat("2 or 4, as the mode ", kMeshoptModes[static_cast<size_t>(layout.mode)], " needs");
  }
  if (stride < 4 || stride > kMostMeshoptStride || stride % 4 != 0) {
    return absl::StrCat("a multiple of 4 from 4 to ", kMostMeshoptStride);
  }
  if (layout.filter == MeshoptFilter::kOctahedral && stride != 4 && stride != 8) {
    return "4 or 8, as the filter OCTAHEDRAL needs";
  }
  if (layout.filter == MeshoptFilter::kQuaternion && stride != 8) return "8, as the filter QUATERNION needs";
  return std::nullopt;
}

absl::Status CheckLayout(const MeshoptLayout& layout) {
  if (const auto wanted = WrongStride(layout)) return Bad("byteStride ", layout.stride, " is not ", *wanted);
  if (layout.count == 0) return Bad("count 0 is not 1 or more");
  if (layout.mode == MeshoptMode::kTriangles && layout.count % 3 != 0) {
    return Bad("count ", layout.count, " is not a multiple of 3, as the mode TRIANGLES needs");
  }
  if (layout.mode != MeshoptMode::kAttributes && layout.filter != MeshoptFilter::kUnfiltered) {
    return Bad("filter \"", kMeshoptFilters[static_cast<size_t>(layout.filter)], "\" is not NONE, as the mode ",
               kMeshoptModes[static_cast<size_t>(layout.mode)], " needs");
  }
  return absl::OkStatus();
}

absl::StatusOr<MeshoptLayout> MeshoptLayoutOf(const SortedJson& extension) {
  const auto count = GltfNumber(extension, "count"), stride = GltfNumber(extension, "byteStride");
  const auto mode = OneOf<MeshoptMode>(kMeshoptModes, "mode", extension.at("mode").get<std::string>());
  const auto filter = OneOf<MeshoptFilter>(kMeshoptFilters, "filter", extension.value("filter", "NONE"));
  for (const absl::Status& status : {count.status(), stride.status(), mode.status(), filter.status()}) {
    if (!status.ok()) return status;
  }
  const MeshoptLayout layout{*mode, *filter, *count, *stride};
  if (auto status = CheckLayout(layout); !status.ok()) return status;
  return layout;
}

// Compares the size of the result with the buffer view, the stream and the limit, before memory is taken for it.
absl::StatusOr<uint64_t> DecodedSize(const MeshoptLayout& layout, const SortedJson& view, size_t stream,
                                     uint64_t most) {
  if (layout.count > most / layout.stride) {
    return absl::ResourceExhaustedError(absl::StrCat("count ", layout.count, " of byteStride ", layout.stride,
                                                     " exceeds ", most,
                                                     ", the bytes that the limit for all decoded streams leaves"));
  }
  const uint64_t size = layout.count * layout.stride;
  const auto length = GltfNumber(view, "byteLength"), stride = GltfNumber(view, "byteStride", layout.stride);
  if (!length.ok() || !stride.ok()) return length.ok() ? stride.status() : length.status();
  if (*stride != layout.stride) {
    return Bad("byteStride ", layout.stride, " is not ", *stride, ", that of the buffer view");
  }
  if (*length != size) {
    return Bad("count ", layout.count, " of byteStride ", layout.stride, " is ", size, " bytes, not ", *length,
               ", the byteLength of the buffer view");
  }
  if (size / kMostMeshoptGrowth > stream) {
    return Bad("byteLength ", stream, " is too short for ", size, " bytes: streams grow at most ", kMostMeshoptGrowth,
               " times");
  }
  return size;
}

// Returns the code of the library.
int DecodeStream(const MeshoptLayout& layout, absl::string_view stream, std::string& out) {
  const auto* const bytes = reinterpret_cast<const unsigned char*>(stream.data());
  switch (layout.mode) {
    case MeshoptMode::kAttributes:
      return meshopt_decodeVertexBuffer(out.data(), layout.count, layout.stride, bytes, stream.size());
    case MeshoptMode::kTriangles:
      return meshopt_decodeIndexBuffer(out.data(), layout.count, layout.stride, bytes, stream.size());
    case MeshoptMode::kIndices:
      break;
  }
  return meshopt_decodeIndexSequence(out.data(), layout.count, layout.stride, bytes, stream.size());
}

void ApplyFilter(const MeshoptLayout& layout, std::string& out) {
  switch (layout.filter) {
    case MeshoptFilter::kUnfiltered:
      return;
    case MeshoptFilter::kOctahedral:
      return meshopt_decodeFilterOct(out.data(), layout.count, layout.stride);
    case MeshoptFilter::kQuaternion:
      return meshopt_decodeFilterQuat(out.data(), layout.count, layout.stride);
    case MeshoptFilter::kExponential:
      return meshopt_decodeFilterExp(out.data(), layout.count, layout.stride);
  }
}

bool IsVersion1OfAttributes(absl::string_view stream) { return !stream.empty() && stream[0] == '\xA1'; }

}  // namespace

GltfMeshopt GltfMeshoptOf(const SortedJson& owner) {
  const auto extensions = owner.find("extensions");
  if (extensions == owner.end()) return {};
  for (const absl::string_view name : kMeshoptNames) {
    const auto found = extensions->find(name);
    if (found != extensions->end()) return {name, &*found};
  }
  return {};
}

bool IsNewerMeshopt(const SortedJson& extension, absl::string_view stream) {
  if (extension.value("mode", "") != kMeshoptModes[0]) return false;
  return IsVersion1OfAttributes(stream) || extension.value("filter", "") == "COLOR";
}

absl::StatusOr<std::string> DecodeGltfMeshopt(const SortedJson& extension, const SortedJson& view,
                                              absl::string_view stream, uint64_t most) {
  const auto layout = MeshoptLayoutOf(extension);
  if (!layout.ok()) return layout.status();
  const auto size = DecodedSize(*layout, view, stream.size(), most);
  if (!size.ok()) return size.status();
  const absl::string_view mode = kMeshoptModes[static_cast<size_t>(layout->mode)];
  if (layout->mode == MeshoptMode::kAttributes && IsVersion1OfAttributes(stream)) {
    return Bad("the stream of mode ATTRIBUTES has version 1; latvox reads version 0, that of EXT_meshopt_compression");
  }
  std::string out(*size, '\0');
  const int code = DecodeStream(*layout, stream, out);
  if (code == -1) {
    const auto first = static_cast<uint8_t>(stream.empty() ? '\0' : stream[0]);
    return Bad("the stream does not begin like one of mode ", mode, ": its first byte is ", int{first});
  }
  if (code != 0) {
    return Bad("the stream of mode ", mode, " is damaged: its ", stream.size(), " bytes are ",
               code == -3 ? "more than" : "not", " those of ", layout->count, " elements");
  }
  ApplyFilter(*layout, out);
  return out;
}

}  // namespace latvox::client
