// Darker hollows of pictures: what their surroundings hide of the sky.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_HOLLOWS_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_HOLLOWS_H_

#include <array>
#include <cstddef>
#include <vector>

namespace latvox::client {

// Searches for occluders of the sky: in eight directions, at five distances. A picture has 2 x 2 samples for each
// pixel, and the directions differ among them.
class Hollows {
 public:
  explicit Hollows(int wide);  // samples of the picture's side

  // Returns the hidden share of the sky over a sample, by the height of the surroundings over the tangent plane. Where
  // the surface is seen edge-on, its tangent plane is not known well enough.
  //   depth    of all samples, in samples; rows from the top; kNoDepth without a surface
  //   normal   of the surface: x to the right, y up, z toward the viewer
  float Share(const std::vector<float>& depth, int x, int y, const std::array<float, 3>& normal) const;

 private:
  static constexpr size_t kDirections = 8, kDistances = 5, kPhases = 4;

  // The taps of all directions at about one distance.
  struct Ring {
    std::array<int, kDirections> dx, dy, offset;  // offset: of the sample in an array
    std::array<float, kDirections> right, down;   // dx and dy
    float inverse;                                // of the distance
  };
  using Heights = std::array<float, kDirections>;

  Heights Around(const float* depth, int x, int y, const Ring& ring) const;

  const int wide_;
  const float reach_;
  std::array<std::array<Ring, kDistances>, kPhases> rings_{};
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_HOLLOWS_H_
