#include "client/mesh/gltf_check.h"

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/mesh/gltf_buffers.h"
#include "client/mesh/gltf_sparse.h"

namespace latvox::client {
namespace {

using Json = nlohmann::json;

constexpr int kTriangles = 4;  // the mode that primitives have by default

template <class... Parts>
absl::Status Bad(const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat(parts...));
}

// The text and the first binary chunk of a file.
struct Document {
  absl::string_view text, binary;
};

// A .glb is a header of 12 bytes and chunks: their length, their kind, and so many bytes.
absl::StatusOr<Document> TakeApart(absl::string_view bytes) {
  if (!absl::StartsWith(bytes, "glTF")) return Document{bytes, {}};
  Document document;
  size_t at = 12;
  for (absl::string_view* chunk : {&document.text, &document.binary}) {
    if (chunk == &document.binary && at == bytes.size()) break;
    uint32_t length = 0;
    if (at + 8 > bytes.size()) return Bad("ends at byte ", bytes.size(), ", within a chunk's header");
    std::memcpy(&length, bytes.data() + at, sizeof(length));
    at += 8;
    if (length > bytes.size() - at) {
      return Bad("ends at byte ", bytes.size(), ", within a chunk of ", length, " bytes from ", at, " on");
    }
    *chunk = bytes.substr(at, length);
    at += length;
  }
  return document;
}

// The bytes of an accessor's numbers, all of them; nothing if they are not there.
//   changed   where they lie if it is sparse
absl::string_view BytesOf(const Json& accessor, const Json& root, GltfBuffers& buffers, std::string& changed) {
  if (accessor.contains("sparse")) return changed = SparseBytes(accessor, root, buffers);
  if (!accessor.contains("bufferView")) return {};
  const Json& view = root.at("bufferViews").at(accessor.at("bufferView").get<size_t>());
  const absl::string_view buffer = buffers.At(view.at("buffer").get<size_t>());
  const size_t begin = view.value("byteOffset", size_t{0}) + accessor.value("byteOffset", size_t{0});
  const size_t size = GltfComponentSize(accessor.at("componentType").get<int>());
  const auto count = accessor.at("count").get<size_t>();
  if (begin > buffer.size() || count > (buffer.size() - begin) / size) return {};
  return buffer.substr(begin, count * size);
}

absl::Status CheckIndices(const Json& primitive, const Json& root, GltfBuffers& buffers) try {
  const Json& accessors = root.at("accessors");
  const Json& positions = accessors.at(primitive.at("attributes").at("POSITION").get<size_t>());
  const auto vertices = positions.at("count").get<uint64_t>();
  const bool indexed = primitive.contains("indices");
  const size_t number = indexed ? primitive.at("indices").get<size_t>() : 0;
  const uint64_t corners = indexed ? accessors.at(number).at("count").get<uint64_t>() : vertices;
  if (corners % 3 != 0) return Bad(corners, " corners of triangles are not a multiple of 3");
  if (!indexed) return absl::OkStatus();
  const Json& accessor = accessors.at(number);
  const int component = accessor.at("componentType").get<int>();
  if (!IsGltfIndex(component) || accessor.at("type") != "SCALAR") {
    return Bad("indices are ", accessor.at("type").dump(), " of componentType ", component,
               ", not \"SCALAR\" of 5121, 5123 or 5125");
  }
  std::string changed;
  const absl::string_view bytes = BytesOf(accessor, root, buffers, changed);
  const size_t size = GltfComponentSize(component);
  for (size_t n = 0; n * size < bytes.size(); ++n) {
    uint32_t index = 0;
    std::memcpy(&index, bytes.data() + n * size, size);  // little-endian, as this machine is
    if (index < vertices) continue;
    return Bad("vertex index ", index, " of triangle ", n / 3, " is not within the ", vertices, " vertices");
  }
  return absl::OkStatus();
} catch (const Json::exception&) {
  return absl::OkStatus();  // a field is missing or of another type: assimp's to say
}

// Errors: also the JSON library's exceptions.
absl::Status CheckPrimitives(const Json& root, GltfBuffers& buffers) {
  const Json none = Json::array();
  size_t mesh = 0;
  for (const Json& each : root.value("meshes", none)) {
    size_t n = 0;
    for (const Json& primitive : each.value("primitives", none)) {
      const bool compressed = primitive.value("extensions", Json::object()).contains("KHR_draco_mesh_compression");
      if (primitive.value("mode", kTriangles) == kTriangles && !compressed) {
        const absl::Status status = CheckIndices(primitive, root, buffers);
        if (!status.ok()) return Bad("meshes[", mesh, "].primitives[", n, "]: ", status.message());
      }
      ++n;
    }
    ++mesh;
  }
  return absl::OkStatus();
}

// Errors: also the JSON library's exceptions. A name that stands twice in an object would be one value here and another
// for assimp.
absl::StatusOr<Json> ParseDocument(absl::string_view text) {
  std::vector<std::set<std::string>> open;  // names so far in each object that has not ended
  std::string twice;
  const auto see = [&](int, Json::parse_event_t event, const Json& parsed) {
    if (event == Json::parse_event_t::object_start) open.emplace_back();
    if (event == Json::parse_event_t::object_end) open.pop_back();
    if (event != Json::parse_event_t::key) return true;
    if (!open.back().insert(parsed.get<std::string>()).second) twice = parsed.get<std::string>();
    return true;
  };
  Json root = Json::parse(text, see);
  if (!twice.empty()) return Bad("JSON: \"", twice, "\" stands twice in an object");
  return root;
}

}  // namespace

absl::Status CheckGltf(absl::string_view bytes, const std::filesystem::path& folder) {
  const auto document = TakeApart(bytes);
  if (!document.ok()) return document.status();
  absl::StatusOr<Json> root;
  try {
    root = ParseDocument(document->text);
  } catch (const Json::exception& error) {
    const absl::string_view what = error.what();  // "[json.exception.parse_error.101] parse error at line 2, ..."
    return Bad("JSON: ", what.substr(what.find("] ") + 2));
  }
  if (!root.ok()) return root.status();
  GltfBuffers buffers(*root, document->binary, folder);
  if (absl::Status status = CheckSparse(*root, buffers); !status.ok()) return status;
  try {
    return CheckPrimitives(*root, buffers);
  } catch (const Json::exception&) {
    return absl::OkStatus();  // likewise
  }
}

}  // namespace latvox::client
