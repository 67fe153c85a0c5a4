// Colors of glTF primitives.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_COLOR_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_COLOR_H_

#include <array>
#include <string>

#include "client/json/json.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

using LinearColor = std::array<double, 3>;  // red, green, blue; 1 is full intensity

// The base color of a material without its texture.
struct GltfBaseColor {
  LinearColor factor{1, 1, 1};
  std::string textured = "";  // name of the material, if it has a texture of base color
};

// Returns the base color of the primitive's material; white without a material.
GltfBaseColor GltfBaseColorOf(const SortedJson& primitive, const SortedJson& root);

// Converts linear intensities, clamped to 0 and 1, to the nearest bytes of sRGB.
Color ToSrgb(const LinearColor& linear);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_COLOR_H_
