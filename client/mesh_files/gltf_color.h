// Colors of glTF primitives.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_COLOR_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_COLOR_H_

#include <string>

#include "client/json/json.h"
#include "client/mesh/srgb.h"

namespace latvox::client {

// The base color of a material without its texture.
struct GltfBaseColor {
  LinearColor factor{1, 1, 1};
  double opacity = 1;
  std::string textured = "";     // name of the material, if it has a texture of base color
  SortedJson texture = nullptr;  // the object that names the texture; null: none
};

// Returns the base color of the primitive's material; white without a material.
GltfBaseColor GltfBaseColorOf(const SortedJson& primitive, const SortedJson& root);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_COLOR_H_
