// Base colors of points of a mesh.
#ifndef LATVOX_CLIENT_TOOL_TEXTURE_BASE_COLOR_SAMPLER_H_
#define LATVOX_CLIENT_TOOL_TEXTURE_BASE_COLOR_SAMPLER_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"
#include "client/tool/texture/texture.h"

namespace latvox::client {

// Not thread-safe. Memory: 4 bytes for each pixel of the textures; 5 more for large voxels.
class BaseColorSampler {
 public:
  // Decodes the images of the mesh, and gives up their files. With skip_bad, an image that cannot be decoded is white,
  // with the warning BAD_ELEMENTS. Errors: those of DecodeImage, with the image's name.
  static absl::StatusOr<BaseColorSampler> Create(std::shared_ptr<Mesh> mesh, bool skip_bad,
                                                 std::vector<Warning>& warnings);

  struct Sample {
    LinearRgba color{1, 1, 1, 1};
    bool has_image = false;  // otherwise the colors of vertices count, and only opacity is new
  };

  // Returns the base color at a point: factor times COLOR_0 of the corners, interpolated, times the image. The image
  // counts as a mean over a rectangle, onto which it maps a square of this edge in the triangle's plane.
  //   triangle   of the mesh
  //   weights    of its second and third corner
  //   edge       world units
  Sample At(size_t triangle, const std::array<float, 2>& weights, double edge);

 private:
  explicit BaseColorSampler(std::shared_ptr<const Mesh> mesh) : mesh_(std::move(mesh)) {}

  std::array<Interval, 2> RectangleOf(size_t triangle, const std::array<double, 3>& weights, double edge) const;

  std::shared_ptr<const Mesh> mesh_;
  std::vector<std::shared_ptr<Texture>> textures_;  // of each of Mesh::base_colors.all; null: none
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_TEXTURE_BASE_COLOR_SAMPLER_H_
