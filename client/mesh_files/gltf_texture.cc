#include "client/mesh_files/gltf_texture.h"

#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/gltf_color.h"
#include "client/mesh_files/gltf_document.h"

namespace latvox::client {
namespace {

constexpr char kTransform[] = "KHR_texture_transform";

// Returns an extension of the object, or null.
const SortedJson* ExtensionOf(const SortedJson& object, const char* name) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end() || !extensions->contains(name)) return nullptr;
  return &extensions->at(name);
}

absl::StatusOr<Wrap> WrapOf(const SortedJson& sampler, const char* name) {
  constexpr uint64_t kRepeat = 10497, kMirror = 33648, kClamp = 33071;
  const auto number = GltfNumber(sampler, name, kRepeat);
  if (!number.ok()) return number.status();
  if (*number == kRepeat) return Wrap::kRepeat;
  if (*number == kMirror) return Wrap::kMirror;
  if (*number == kClamp) return Wrap::kClamp;
  return Bad(name, " ", *number, " is not one of ", kRepeat, ", ", kMirror, ", ", kClamp);
}

absl::Status ReadSampler(const SortedJson& sampler, BaseColor& color) {
  constexpr uint64_t kNearest = 9728, kLinear = 9729;
  const auto u = WrapOf(sampler, "wrapS"), v = WrapOf(sampler, "wrapT");
  const auto filter = GltfNumber(sampler, "magFilter", kLinear);
  if (!u.ok() || !v.ok()) return u.ok() ? v.status() : u.status();
  if (!filter.ok()) return filter.status();
  color.wraps = {*u, *v};
  color.is_smooth = *filter != kNearest;
  return absl::OkStatus();
}

// Scale, then rotation, then translation. The rotation is counter-clockwise as one sees the image, with v downward: so
// say the extension's words, its example and its test model. Its lines of GLSL have the sign of the angle reversed.
void ReadTransform(const SortedJson& transform, GltfTexture& texture) {
  using Pair = std::array<double, 2>;
  const auto offset = transform.value("offset", Pair{0, 0}), scale = transform.value("scale", Pair{1, 1});
  const double angle = transform.value("rotation", 0.0), c = std::cos(angle), s = std::sin(angle);
  texture.place = {{{c * scale[0], s * scale[1], offset[0]}, {-s * scale[0], c * scale[1], offset[1]}}};
}

}  // namespace

ImagePoint GltfTexture::Apply(double u, double v) const {
  ImagePoint point;
  for (size_t n = 0; n < 2; ++n) point[n] = static_cast<float>(place[n][0] * u + place[n][1] * v + place[n][2]);
  return point;
}

absl::StatusOr<GltfTexture> GltfTextures::Of(const SortedJson& primitive) {
  const GltfBaseColor base = GltfBaseColorOf(primitive, root_);
  GltfTexture texture;
  for (size_t n = 0; n < 3; ++n) texture.color.factor[n] = static_cast<float>(base.factor[n]);
  texture.color.factor[3] = static_cast<float>(base.opacity);
  if (base.texture.is_null()) return texture;
  if (auto status = Read(base.texture, texture); !status.ok()) {
    return absl::Status(status.code(), absl::StrCat(base.textured, ": ", status.message()));
  }
  return texture;
}

absl::Status GltfTextures::Read(const SortedJson& info, GltfTexture& out) {
  const auto number = GltfIndex(info, "index", root_, "textures");
  const SortedJson* const transform = ExtensionOf(info, kTransform);
  const bool is_moved = transform != nullptr && transform->contains("texCoord");
  const auto set = GltfNumber(is_moved ? *transform : info, "texCoord", 0);
  if (!number.ok() || !set.ok()) return number.ok() ? set.status() : number.status();
  out.set = *set;
  if (transform != nullptr) ReadTransform(*transform, out);
  const SortedJson& texture = root_.at("textures").at(*number);
  if (texture.contains("sampler")) {
    const auto sampler = GltfIndex(texture, "sampler", root_, "samplers");
    if (!sampler.ok()) return sampler.status();
    const absl::Status status = ReadSampler(root_.at("samplers").at(*sampler), out.color);
    if (!status.ok()) return absl::Status(status.code(), absl::StrCat("samplers[", *sampler, "]: ", status.message()));
  }
  auto image = ImageOf(texture);
  if (image.ok()) {
    out.color.image = *std::move(image);
    return absl::OkStatus();
  }
  const std::string name = absl::StrCat("textures[", *number, "]");
  return bad_.Add(absl::Status(image.status().code(), absl::StrCat(name, ": ", image.status().message())), name);
}

absl::StatusOr<GltfTextures::Image> GltfTextures::ImageOf(const SortedJson& texture) {
  const SortedJson* const webp = ExtensionOf(texture, "EXT_texture_webp");
  const SortedJson& source = webp != nullptr && webp->contains("source") ? *webp : texture;
  if (!source.contains("source")) return Bad("has no image that is PNG, JPEG or WebP");
  const auto number = GltfIndex(source, "source", root_, "images");
  if (!number.ok()) return number.status();
  const auto [found, is_new] = images_.try_emplace(*number);
  if (!is_new) return found->second;
  const std::string name = absl::StrCat("images[", *number, "]");
  auto bytes = BytesOf(root_.at("images").at(*number));
  if (!bytes.ok()) return absl::Status(bytes.status().code(), absl::StrCat(name, ": ", bytes.status().message()));
  found->second = std::make_shared<EncodedImage>(EncodedImage{name, *std::move(bytes)});
  return found->second;
}

absl::StatusOr<std::string> GltfTextures::BytesOf(const SortedJson& image) {
  if (image.contains("uri")) return buffers_.Uri(image.at("uri").get_ref<const std::string&>());
  const auto bytes = buffers_.View(image);
  if (!bytes.ok()) return bytes.status();
  return std::string(*bytes);
}

}  // namespace latvox::client
