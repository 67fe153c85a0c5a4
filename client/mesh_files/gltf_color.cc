#include "client/mesh_files/gltf_color.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

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
  GltfBaseColor color{{factor[0], factor[1], factor[2]}};
  if (look.contains(specular ? "diffuseTexture" : "baseColorTexture")) {
    const std::string name = material.value("name", "");
    color.textured =
        name.empty() ? absl::StrCat("materials[", number.dump(), "]") : absl::StrCat("material \"", name, "\"");
  }
  return color;
}

Color ToSrgb(const LinearColor& linear) {
  Color bytes;
  for (size_t n = 0; n < 3; ++n) {
    const double c = std::min(std::max(0.0, linear[n]), 1.0);
    const double encoded = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
    bytes[n] = static_cast<uint8_t>(std::nearbyint(encoded * 255));
  }
  return bytes;
}

}  // namespace latvox::client
