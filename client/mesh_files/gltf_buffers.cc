#include "client/mesh_files/gltf_buffers.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/gltf_meshopt.h"
#include "client/mesh_files/input.h"

namespace latvox::client {
namespace {

// Decodes "%20" and the like.
std::string Unescaped(absl::string_view uri) {
  const auto is_digit = [&](size_t n) { return n < uri.size() && absl::ascii_isxdigit(static_cast<uint8_t>(uri[n])); };
  std::string text;
  for (size_t n = 0; n < uri.size(); ++n) {
    uint32_t byte = 0;
    if (uri[n] == '%' && is_digit(n + 1) && is_digit(n + 2) && absl::SimpleHexAtoi(uri.substr(n + 1, 2), &byte)) {
      text += static_cast<char>(byte);
      n += 2;
    } else {
      text += uri[n];
    }
  }
  return text;
}

}  // namespace

absl::StatusOr<std::string> GltfBuffers::Uri(absl::string_view uri) const {
  constexpr absl::string_view kBase64 = ";base64,";
  if (absl::StartsWith(uri, "data:")) {
    std::string bytes;
    const size_t begin = uri.find(kBase64);
    if (begin != absl::string_view::npos && absl::Base64Unescape(uri.substr(begin + kBase64.size()), &bytes))
      return bytes;
    return Bad("its data: URI is not base64");
  }
  std::error_code error;
  std::string name = Unescaped(uri);
  if (!std::filesystem::exists(folder_ / name, error)) std::replace(name.begin(), name.end(), '\\', '/');  // of Windows
  const std::filesystem::path path = folder_ / name;
  // Only regular files: others may never end.
  if (!std::filesystem::is_regular_file(path, error)) return Bad("file \"", uri, "\" cannot be read");
  return ReadBytes(path);
}

absl::StatusOr<absl::string_view> GltfBuffers::At(uint64_t n) {
  const SortedJson& buffer = document_.root.at("buffers").at(n);
  const auto length = GltfNumber(buffer, "byteLength");
  if (!length.ok()) return Bad("buffers[", n, "]: ", length.status().message());
  absl::string_view bytes = document_.binary;
  if (buffer.contains("uri")) {
    const auto [found, is_new] = read_.try_emplace(n);
    if (is_new) {
      auto read = Uri(buffer.at("uri").get_ref<const std::string&>());
      if (!read.ok()) {
        return absl::Status(read.status().code(), absl::StrCat("buffers[", n, "]: ", read.status().message()));
      }
      found->second = *std::move(read);
    }
    bytes = found->second;
  } else if (n > 0 || bytes.data() == nullptr) {
    if (const GltfMeshopt meshopt = GltfMeshoptOf(buffer); meshopt.object != nullptr) {
      return Bad("buffers[", n, "] is a fallback without bytes, for buffer views with ", meshopt.name);
    }
    return Bad("buffers[", n, "] has no uri, and is not the binary chunk of a .glb");
  }
  if (bytes.size() < *length) return Bad("buffers[", n, "] has ", bytes.size(), " bytes, not ", *length);
  return bytes;
}

// Returns the bytes that a buffer view, or its extension, names.
absl::StatusOr<absl::string_view> GltfBuffers::Range(const SortedJson& object, const std::string& place) {
  const auto buffer = GltfIndex(object, "buffer", document_.root, "buffers");
  const auto begin = GltfNumber(object, "byteOffset", 0), length = GltfNumber(object, "byteLength");
  for (const auto* field : {&buffer, &begin, &length}) {
    if (!field->ok()) return Bad(place, ": ", field->status().message());
  }
  const auto bytes = At(*buffer);
  if (!bytes.ok()) return bytes;
  if (*begin + *length > bytes->size()) {
    return Bad(place, " ends at byte ", *begin + *length, " of buffer ", *buffer, ", which has ", bytes->size());
  }
  return bytes->substr(*begin, *length);
}

// Returns the bytes of a compressed buffer view.
absl::StatusOr<absl::string_view> GltfBuffers::Decoded(uint64_t n) {
  if (const auto found = decoded_.find(n); found != decoded_.end()) return absl::string_view(found->second);
  const SortedJson& view = document_.root.at("bufferViews").at(n);
  const GltfMeshopt meshopt = GltfMeshoptOf(view);
  const std::string place = absl::StrCat("bufferViews[", n, "].", meshopt.name);
  const auto stream = Range(*meshopt.object, place);
  if (!stream.ok()) return stream;
  const auto required = document_.root.value("extensionsRequired", std::vector<std::string>());
  const bool is_required = std::find(required.begin(), required.end(), meshopt.name) != required.end();
  if (!is_required && IsNewerMeshopt(*meshopt.object, *stream))
    return Range(view, absl::StrCat("bufferViews[", n, "]"));
  auto bytes = DecodeGltfMeshopt(*meshopt.object, view, *stream, left_);
  if (!bytes.ok()) return absl::Status(bytes.status().code(), absl::StrCat(place, ": ", bytes.status().message()));
  left_ -= bytes->size();
  return absl::string_view(decoded_[n] = *std::move(bytes));
}

absl::StatusOr<absl::string_view> GltfBuffers::View(const SortedJson& object) {
  const auto number = GltfIndex(object, "bufferView", document_.root, "bufferViews");
  if (!number.ok()) return number.status();
  const SortedJson& view = document_.root.at("bufferViews").at(*number);
  if (GltfMeshoptOf(view).object != nullptr) return Decoded(*number);
  return Range(view, absl::StrCat("bufferViews[", *number, "]"));
}

absl::StatusOr<absl::string_view> GltfBuffers::Bytes(const SortedJson& object, uint64_t size) {
  const auto view = View(object);
  const auto offset = GltfNumber(object, "byteOffset", 0);
  if (!view.ok() || !offset.ok()) return view.ok() ? offset.status() : view.status();
  if (*offset + size > view->size()) {
    return Bad("needs bytes ", *offset, " to ", *offset + size, " of bufferView ", object.at("bufferView").dump(),
               ", which has ", view->size());
  }
  return view->substr(*offset, size);
}

}  // namespace latvox::client
