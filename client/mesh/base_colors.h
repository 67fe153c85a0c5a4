// The base colors of triangles: factors, textures and opacity, as far as colors of vertices cannot hold them.
#ifndef LATVOX_CLIENT_MESH_BASE_COLORS_H_
#define LATVOX_CLIENT_MESH_BASE_COLORS_H_

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace latvox::client {

using LinearRgba = std::array<float, 4>;  // red, green, blue, opacity; linear, 1 is full

// A file of pixels, not yet decoded.
struct EncodedImage {
  std::string name;   // for errors
  std::string bytes;  // foreign
};

// The pixels that a texture shows beyond its image.
enum class Wrap {
  kRepeat,  // the image again
  kMirror,  // its mirror image, and so on by turns
  kClamp,   // its outermost pixels
};

// The base color of a material: the factor times the image.
struct BaseColor {
  LinearRgba factor{1, 1, 1, 1};
  std::shared_ptr<EncodedImage> image = nullptr;  // null: none; materials share images
  std::array<Wrap, 2> wraps{};                    // along u and v
  bool is_smooth = true;                          // between pixels; otherwise each pixel is a plain rectangle
};

// A position in an image: 0, 0 is its upper left corner, 1, 1 its lower right one.
using ImagePoint = std::array<float, 2>;

struct TriangleBaseColor {
  static constexpr uint32_t kNone = UINT32_MAX;
  uint32_t number = kNone;              // in BaseColors::all
  std::array<ImagePoint, 3> corners{};  // unused without an image
};

struct BaseColors {
  std::vector<BaseColor> all;
  std::vector<TriangleBaseColor> triangles = {};         // of the mesh; those beyond the end have none
  std::vector<std::array<LinearRgba, 3>> vertices = {};  // further factors of their corners; beyond the end: 1
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_BASE_COLORS_H_
