// What a glTF file's accessors are made of.
#ifndef LATVOX_CLIENT_MESH_GLTF_BUFFERS_H_
#define LATVOX_CLIENT_MESH_GLTF_BUFFERS_H_

#include <cstddef>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "absl/strings/string_view.h"

namespace latvox::client {

// The buffers' bytes, each read once; nothing of those that cannot be.
class GltfBuffers {
 public:
  // `root` and `binary`, the chunk of a .glb, must outlive it; `folder`: of the files that are referred to.
  GltfBuffers(const nlohmann::json& root, absl::string_view binary, std::filesystem::path folder)
      : root_(root), binary_(binary), folder_(std::move(folder)) {}

  // Throws the JSON library's exceptions where there is no such buffer, or none that is described.
  absl::string_view At(size_t n);

 private:
  std::string Read(absl::string_view uri) const;

  const nlohmann::json& root_;
  const absl::string_view binary_;
  const std::filesystem::path folder_;
  std::map<size_t, std::string> read_;
};

// Bytes of a component of that type: 5120 to 5126, as glTF counts them; 0: there is no such type.
size_t GltfComponentSize(int type);

// Whether numbers of that type count vertices, or elements: 5121, 5123 or 5125.
inline bool IsGltfIndex(int type) { return type == 5121 || type == 5123 || type == 5125; }

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_GLTF_BUFFERS_H_
