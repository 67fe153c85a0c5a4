// Textures of glTF materials.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_TEXTURE_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_TEXTURE_H_

#include <array>
#include <cstdint>
#include <map>
#include <memory>

#include "absl/status/statusor.h"
#include "client/json/json.h"
#include "client/mesh/base_colors.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/gltf_buffers.h"

namespace latvox::client {

// The base color of a material, and the way from the coordinates of its vertices to places in the image.
struct GltfTexture {
  BaseColor color;
  uint64_t set = 0;                                                    // TEXCOORD_set
  std::array<std::array<double, 3>, 2> place{{{1, 0, 0}, {0, 1, 0}}};  // KHR_texture_transform: rows of a matrix

  ImagePoint Apply(double u, double v) const;
};

// Reads each image once, when it is first needed. Prefers EXT_texture_webp.
class GltfTextures {
 public:
  // All arguments must outlive the object. With skip_bad, materials whose image cannot be read have none.
  GltfTextures(const SortedJson& root, GltfBuffers& buffers, BadElements& bad)
      : root_(root), buffers_(buffers), bad_(bad) {}

  // Returns what the primitive's material says. Errors: INVALID_ARGUMENT naming texture, image, field or file; also
  // exceptions of the JSON library.
  absl::StatusOr<GltfTexture> Of(const SortedJson& primitive);

 private:
  using Image = std::shared_ptr<EncodedImage>;
  absl::Status Read(const SortedJson& info, GltfTexture& texture);
  absl::StatusOr<Image> ImageOf(const SortedJson& texture);
  absl::StatusOr<std::string> BytesOf(const SortedJson& image);

  const SortedJson& root_;
  GltfBuffers& buffers_;
  BadElements& bad_;
  std::map<uint64_t, Image> images_;  // by number; null: cannot be read
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_TEXTURE_H_
