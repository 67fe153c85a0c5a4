#include "client/mesh_files/gltf_color.h"

#include <array>

#include "absl/strings/str_cat.h"

namespace latvox::client {

GltfBaseColor GltfBaseColorOf(const SortedJson& primitive, const SortedJson& root) {
  if (!primitive.contains("material")) return {};
  const SortedJson& number = primitive.at("material");
  const SortedJson& material = root.at("materials").at(number.get<size_t>());
  const SortedJson none = SortedJson::object(), extensions = material.value("extensions", none);
  const bool specular = extensions.contains("KHR_materials_pbrSpecularGlossiness");
  const SortedJson look =
      specular ? extensions.at("KHR_materials_pbrSpecularGlossiness") : material.value("pbrMetallicRoughness", none);
  const auto factor = look.value(specular ? "diffuseFactor" : "baseColorFactor", std::array<double, 4>{1, 1, 1, 1});
  GltfBaseColor color{{factor[0], factor[1], factor[2]}, factor[3]};
  if (const auto texture = look.find(specular ? "diffuseTexture" : "baseColorTexture"); texture != look.end()) {
    color.texture = *texture;
    const std::string name = material.value("name", "");
    color.textured =
        name.empty() ? absl::StrCat("materials[", number.dump(), "]") : absl::StrCat("material \"", name, "\"");
  }
  return color;
}

}  // namespace latvox::client
