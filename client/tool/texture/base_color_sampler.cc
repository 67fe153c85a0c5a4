#include "client/tool/texture/base_color_sampler.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/internal/vec3.h"
#include "client/tool/texture/decode_image.h"

namespace latvox::client {
namespace {

// Decodes an image within what is left of the limit.
absl::StatusOr<std::shared_ptr<Texture>> Decode(EncodedImage& image, uint64_t& left) {
  auto pixels = DecodeImage(image.bytes, left);
  image.bytes = {};
  if (!pixels.ok()) {
    return absl::Status(pixels.status().code(), absl::StrCat(image.name, ": ", pixels.status().message()));
  }
  left -= uint64_t{pixels->width} * pixels->height;
  return std::make_shared<Texture>(*std::move(pixels));
}

}  // namespace

absl::StatusOr<BaseColorSampler> BaseColorSampler::Create(std::shared_ptr<Mesh> mesh, bool skip_bad,
                                                          std::vector<Warning>& warnings) {
  BaseColorSampler sampler(mesh);
  std::map<const EncodedImage*, std::shared_ptr<Texture>> known;
  uint64_t left = kMostPixels;
  for (const BaseColor& color : mesh->base_colors.all) {
    auto& texture = sampler.textures_.emplace_back();
    if (color.image == nullptr) continue;
    const auto [found, is_new] = known.try_emplace(color.image.get());
    if (is_new) {
      auto decoded = Decode(*color.image, left);
      if (!decoded.ok() && !skip_bad) return decoded.status();
      if (decoded.ok()) {
        found->second = *std::move(decoded);
      } else {
        const std::string reason(decoded.status().message());
        warnings.push_back({"BAD_ELEMENTS", absl::StrCat(reason, "; it counts as white"), color.image->name});
      }
    }
    texture = found->second;
  }
  return sampler;
}

BaseColorSampler::Sample BaseColorSampler::At(size_t triangle, const std::array<float, 2>& weights, double edge) {
  const BaseColors& colors = mesh_->base_colors;
  Sample sample;
  if (triangle >= colors.triangles.size()) return sample;
  const uint32_t number = colors.triangles[triangle].number;
  if (number == TriangleBaseColor::kNone) return sample;
  const BaseColor& base = colors.all[number];
  const std::array<double, 3> corners{1 - double{weights[0]} - double{weights[1]}, weights[0], weights[1]};
  sample.color = base.factor;
  if (triangle < colors.vertices.size()) {
    for (size_t n = 0; n < 4; ++n) {
      double factor = 0;
      for (size_t c = 0; c < 3; ++c) factor += corners[c] * static_cast<double>(colors.vertices[triangle][c][n]);
      sample.color[n] *= static_cast<float>(factor);
    }
  }
  Texture* const texture = textures_[number].get();
  sample.has_image = texture != nullptr;
  if (texture == nullptr) return sample;
  const auto [u, v] = RectangleOf(triangle, corners, edge);
  const LinearRgba mean = texture->Mean(u, v, base.wraps, base.is_smooth);
  for (size_t n = 0; n < 4; ++n) sample.color[n] *= mean[n];
  return sample;
}

// The length along u is the edge times the gradient of u in the triangle's plane. So the rectangle has the square's
// area, wherever the image lies turned, but not sheared, on the triangle; and it is the square's image where its sides
// are along u and v.
std::array<Interval, 2> BaseColorSampler::RectangleOf(size_t triangle, const std::array<double, 3>& weights,
                                                      double edge) const {
  const auto& [a, b, c] = mesh_->triangles[triangle];
  const Vec3d &p = mesh_->positions[a], &q = mesh_->positions[b], &r = mesh_->positions[c];
  Vec3d first, second;
  for (size_t m = 0; m < 3; ++m) {
    first[m] = q[m] - p[m];
    second[m] = r[m] - p[m];
  }
  const double aa = Dot(first, first), ab = Dot(first, second), bb = Dot(second, second);
  const Vec3d normal = Cross(first, second);
  const auto& corners = mesh_->base_colors.triangles[triangle].corners;
  std::array<Interval, 2> rectangle;
  for (size_t n = 0; n < 2; ++n) {
    Interval& interval = rectangle[n];
    for (size_t k = 0; k < 3; ++k) interval.center += weights[k] * static_cast<double>(corners[k][n]);
    const double along_first = static_cast<double>(corners[1][n]) - static_cast<double>(corners[0][n]);
    const double along_second = static_cast<double>(corners[2][n]) - static_cast<double>(corners[0][n]);
    const double squared =
        (bb * along_first * along_first - 2 * ab * along_first * along_second + aa * along_second * along_second) /
        Dot(normal, normal);
    interval.length = squared > 0 && std::isfinite(squared) ? edge * std::sqrt(squared) : 0;
    if (!std::isfinite(interval.center)) interval.center = 0;
  }
  return rectangle;
}

}  // namespace latvox::client
