// A glTF document for the tests of its reader, and changes of it.
#ifndef LATVOX_TESTS_UNIT_CLIENT_MESH_FILES_GLTF_DOCUMENT_H_
#define LATVOX_TESTS_UNIT_CLIENT_MESH_FILES_GLTF_DOCUMENT_H_

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "client/json/json.h"
#include "client/mesh_files/gltf_file.h"

namespace latvox::client {

using Triangle = std::array<uint32_t, 3>;

template <class T>
std::string BytesOf(const std::vector<T>& numbers) {
  return std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T));
}

inline std::string Uri(absl::string_view bytes) {
  return absl::StrCat("data:application/octet-stream;base64,", absl::Base64Escape(bytes));
}

// A square as two triangles in one buffer: positions, indices, and `more`, the content of accessor 2.
inline SortedJson Document(const std::string& more = "") {
  const std::string bytes =
      BytesOf<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}) + BytesOf<uint16_t>({0, 1, 2, 2, 1, 3}) + more;
  SortedJson document =
      SortedJson::parse(R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                    {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}],
      "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}]})");
  document["buffers"] = {{{"byteLength", bytes.size()}, {"uri", Uri(bytes)}}};
  document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 60}, {"byteLength", more.size()}});
  return document;
}

inline std::string BufferOf(const SortedJson& document) {
  const auto uri = document["buffers"][0]["uri"].get<std::string>();
  std::string bytes;
  EXPECT_TRUE(absl::Base64Unescape(absl::string_view(uri).substr(uri.find(',') + 1), &bytes));
  return bytes;
}

inline absl::StatusOr<Mesh> Parse(const SortedJson& document) { return ParseGltf(document.dump(), ""); }

// Returns the document with the value at a path replaced.
inline SortedJson With(SortedJson document, const char* place, const SortedJson& value) {
  document[SortedJson::json_pointer(place)] = value;
  return document;
}

inline std::string Refusal(const SortedJson& document) { return std::string(Parse(document).status().message()); }

}  // namespace latvox::client

#endif  // LATVOX_TESTS_UNIT_CLIENT_MESH_FILES_GLTF_DOCUMENT_H_
