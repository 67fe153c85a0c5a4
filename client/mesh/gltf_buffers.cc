#include "client/mesh/gltf_buffers.h"

#include <fstream>
#include <sstream>

#include "absl/strings/escaping.h"
#include "absl/strings/match.h"

namespace latvox::client {

absl::string_view GltfBuffers::At(size_t n) {
  const nlohmann::json& buffer = root_.at("buffers").at(n);
  if (!buffer.contains("uri")) return n == 0 ? binary_ : absl::string_view();
  const auto [at, is_new] = read_.try_emplace(n);
  if (is_new) at->second = Read(buffer.at("uri").get<std::string>());
  return at->second;
}

std::string GltfBuffers::Read(absl::string_view uri) const {
  constexpr absl::string_view kBase64 = ";base64,";
  std::string bytes;
  if (absl::StartsWith(uri, "data:")) {
    const size_t begin = uri.find(kBase64);
    if (begin == absl::string_view::npos || !absl::Base64Unescape(uri.substr(begin + kBase64.size()), &bytes))
      return "";
    return bytes;
  }
  std::ifstream file(folder_ / std::string(uri), std::ios::binary);
  std::ostringstream all;
  all << file.rdbuf();
  return file ? std::move(all).str() : "";
}

size_t GltfComponentSize(int type) {
  switch (type) {
    case 5120:
    case 5121:
      return 1;
    case 5122:
    case 5123:
      return 2;
    case 5125:
    case 5126:
      return 4;
    default:
      return 0;
  }
}

}  // namespace latvox::client
