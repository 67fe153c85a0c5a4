#include "client/mesh/gltf_check.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

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

// The buffers' bytes, each read once; nothing of those that cannot be.
class Buffers {
 public:
  Buffers(const Json& root, absl::string_view binary, std::filesystem::path folder)
      : root_(root), binary_(binary), folder_(std::move(folder)) {}

  absl::string_view At(size_t n) {
    const Json& buffer = root_.at("buffers").at(n);
    if (!buffer.contains("uri")) return n == 0 ? binary_ : absl::string_view();
    const auto [at, is_new] = read_.try_emplace(n);
    if (is_new) at->second = Read(buffer.at("uri").get<std::string>());
    return at->second;
  }

 private:
  std::string Read(absl::string_view uri) const {
    constexpr absl::string_view kBase64 = ";base64,";
    std::string bytes;
    if (absl::StartsWith(uri, "data:")) {
      const size_t begin = uri.find(kBase64);
      if (begin == absl::string_view::npos || !absl::Base64Unescape(uri.substr(begin + kBase64.size()), &bytes)) return "";
      return bytes;
    }
    std::ifstream file(folder_ / std::string(uri), std::ios::binary);
    std::ostringstream all;
    all << file.rdbuf();
    return file ? std::move(all).str() : "";
  }

  const Json& root_;
  const absl::string_view binary_;
  const std::filesystem::path folder_;
  std::map<size_t, std::string> read_;
};

size_t SizeOfComponent(int type) { return type == 5121 ? 1 : type == 5123 ? 2 : type == 5125 ? 4 : 0; }

// The bytes of an accessor's numbers, all of them; nothing if they are not there.
absl::string_view BytesOf(const Json& accessor, const Json& root, Buffers& buffers) {
  if (accessor.contains("sparse") || !accessor.contains("bufferView")) return {};
  const Json& view = root.at("bufferViews").at(accessor.at("bufferView").get<size_t>());
  const absl::string_view buffer = buffers.At(view.at("buffer").get<size_t>());
  const size_t begin = view.value("byteOffset", size_t{0}) + accessor.value("byteOffset", size_t{0});
  const size_t size = SizeOfComponent(accessor.at("componentType").get<int>());
  const auto count = accessor.at("count").get<size_t>();
  if (begin > buffer.size() || size == 0 || count > (buffer.size() - begin) / size) return {};
  return buffer.substr(begin, count * size);
}

absl::Status CheckIndices(const Json& primitive, const Json& root, Buffers& buffers) try {
  const Json& accessors = root.at("accessors");
  const Json& positions = accessors.at(primitive.at("attributes").at("POSITION").get<size_t>());
  const auto vertices = positions.at("count").get<uint64_t>();
  const bool indexed = primitive.contains("indices");
  const size_t number = indexed ? primitive.at("indices").get<size_t>() : 0;
  const uint64_t corners = indexed ? accessors.at(number).at("count").get<uint64_t>() : vertices;
  if (corners % 3 != 0) return Bad(corners, " corners of triangles are not a multiple of 3");
  if (!indexed) return absl::OkStatus();
  const absl::string_view bytes = BytesOf(accessors.at(number), root, buffers);
  const size_t size = bytes.size() / std::max<uint64_t>(corners, 1);
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
absl::Status CheckPrimitives(const Json& root, Buffers& buffers) {
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

}  // namespace

absl::Status CheckGltf(absl::string_view bytes, const std::filesystem::path& folder) {
  const auto document = TakeApart(bytes);
  if (!document.ok()) return document.status();
  Json root;
  try {
    root = Json::parse(document->text);
  } catch (const Json::exception& error) {
    const absl::string_view what = error.what();  // "[json.exception.parse_error.101] parse error at line 2, ..."
    return Bad("JSON: ", what.substr(what.find("] ") + 2));
  }
  try {
    Buffers buffers(root, document->binary, folder);
    return CheckPrimitives(root, buffers);
  } catch (const Json::exception&) {
    return absl::OkStatus();  // likewise
  }
}

}  // namespace latvox::client
