#include "client/tool/output/picture.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "client/internal/vec3.h"
#include "client/tool/output/depth_blur.h"
#include "client/tool/output/facet_rims.h"
#include "client/tool/output/gamma.h"
#include "client/tool/output/voxel_front.h"

namespace latvox::client {
namespace {

constexpr int kSamples = 2;                                // per pixel and axis
constexpr double kFilled = 0.92, kFilledIfCropped = 0.97;  // share of the picture

using Rgb = std::array<float, 3>;  // linear, as all colors here
using Vec3f = std::array<float, 3>;

float FloatDot(const Vec3f& a, const Vec3f& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vec3f Unit(const Vec3f& v) {
  const float length = std::sqrt(FloatDot(v, v));
  return {v[0] / length, v[1] / length, v[2] / length};
}

float Share(float x, float none, float all) { return std::clamp((x - none) / (all - none), 0.0F, 1.0F); }

// Turns a direction from y up to another up axis. x stays on the right if z is up.
Vec3d Turned(const Vec3d& v, UpAxis up) {
  if (up == UpAxis::kY) return v;
  return up == UpAxis::kZ ? Vec3d{v[0], -v[2], v[1]} : Vec3d{v[1], v[2], v[0]};
}

// View frame: x to the right, y up, z toward the viewer, in samples.
class Renderer {
 public:
  Renderer(const VoxelScene& scene, const PictureOptions& options)
      : scene_(scene),
        cancellation_(options.cancellation),
        rims_(scene.facets()),
        side_(options.side),
        wide_(options.side * kSamples),
        filled_(options.crop ? kFilledIfCropped : kFilled) {
    const double a = options.azimuth * std::numbers::pi / 180, e = options.elevation * std::numbers::pi / 180;
    right_ = Turned({std::cos(a), 0, -std::sin(a)}, options.up);
    towards_ = Turned({std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a)}, options.up);
    up_ = Cross(towards_, right_);
    for (size_t level = 0; level < linear_.size(); ++level) linear_[level] = IntensityOf(static_cast<uint8_t>(level));
    for (size_t m = 0; m < 3; ++m) color_[m] = linear_[options.color[m]];
    for (const VoxelScene::Facet& facet : scene.facets()) normals_.push_back(ToView(facet.normal));
    const size_t samples = static_cast<size_t>(wide_) * static_cast<size_t>(wide_);
    depth_.resize(samples, kNoDepth);
    facet_.resize(samples);
    edge_.resize(samples);
    if (scene.colored()) colors_.resize(samples);
    MakeTaps();
    constexpr float kSpread = 0.06F;  // for soft shadows
    for (int phase = 0; phase < kSamples * kSamples; ++phase) {
      const float dx = kSpread * static_cast<float>(phase % kSamples),
                  dy = kSpread * static_cast<float>(phase / kSamples);
      lights_[static_cast<size_t>(phase)] = Unit({-0.52F + dx, 0.66F, 0.50F + dy});
    }
  }

  // Returns the cells, with nothing behind them.
  Image Draw() {
    Image picture(side_, side_);
    Frame();
    MakeFronts();
    ForRows(wide_, [this](int y) { CastRow(y); });
    if (cancellation_.cancelled()) return picture;
    smooth_ = SmoothDepth(depth_, wide_, std::clamp(static_cast<int>(2.0F * cell_), 2, 32));
    ForRows(side_, [&](int y) {
      for (int x = 0; x < side_; ++x) ShadePixel(x, y, picture.At(x, y));
    });
    return picture;
  }

  // Returns the pixels of the picture per unit of the world.
  double Scale() const { return scale_ / kSamples / scene_.cell_size(); }

 private:
  template <class Row>
  void ForRows(int rows, const Row& row) const {
    tbb::parallel_for(0, rows, [&](int y) {
      if (!cancellation_.cancelled()) row(y);
    });
  }

  Vec3f ToView(const Vec3d& v) const {
    return {static_cast<float>(Dot3(v, right_)), static_cast<float>(Dot3(v, up_)),
            static_cast<float>(Dot3(v, towards_))};
  }
  static double Dot3(const Vec3d& a, const Vec3d& b) { return latvox::client::Dot(a, b); }
  Vec3d ToScene(const Vec3f& v) const { return Sum(Sum(Sum({}, v[0], right_), v[1], up_), v[2], towards_); }

  size_t At(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(wide_) + static_cast<size_t>(x); }

  void Frame() {
    constexpr double kFar = std::numeric_limits<double>::max();
    Vec3d low = {kFar, kFar, kFar}, high = {-kFar, -kFar, -kFar}, reach{};
    for (const Vec3d& corner : scene_.cell_corners()) {
      const Vec3f view = ToView(corner);
      for (size_t m = 0; m < 3; ++m) reach[m] = std::max(reach[m], double{view[m]});
    }
    scene_.ForEachOuter([&](const Vec3i& cell) {
      const Vec3d at = scene_.CenterOf(cell);
      const Vec3d view = {Dot3(at, right_), Dot3(at, up_), Dot3(at, towards_)};
      for (size_t m = 0; m < 3; ++m) {
        low[m] = std::min(low[m], view[m]);
        high[m] = std::max(high[m], view[m]);
      }
    });
    if (scene_.empty()) low = high = {};
    scale_ = filled_ * wide_ / (std::max(high[0] - low[0] + 2 * reach[0], high[1] - low[1] + 2 * reach[1]));
    const Vec3f middle = {static_cast<float>((low[0] + high[0]) / 2), static_cast<float>((low[1] + high[1]) / 2),
                          static_cast<float>(high[2] + reach[2] + 1)};
    eye_ = ToScene(middle);
    cell_ = static_cast<float>(scale_);
  }

  void MakeFronts() {
    tbb::parallel_for(size_t{0}, fronts_.size(), [&](size_t n) {
      if (!cancellation_.cancelled()) fronts_[n].emplace(scene_, n == 0 ? towards_ : ToScene(lights_[n - 1]));
    });
  }

  void CastRow(int y) {
    const Vec3d back = {-towards_[0], -towards_[1], -towards_[2]};
    for (int x = 0; x < wide_; ++x) {
      const Vec3d eye = SceneAt(static_cast<float>(x), static_cast<float>(y), 0);
      const double front = fronts_.front()->Reach(eye);
      if (!std::isfinite(front)) continue;
      const Ray ray{Sum(eye, front, towards_), back};
      const auto hit = scene_.Cast(ray);
      if (!hit) continue;
      depth_[At(x, y)] = static_cast<float>((front - hit->t) * scale_);
      facet_[At(x, y)] = static_cast<uint8_t>(hit->facet);
      edge_[At(x, y)] = EdgeAt(Sum(ray.from, hit->t, back), *hit);
      if (!colors_.empty()) colors_[At(x, y)] = scene_.ColorOf(hit->cell);
    }
  }

  Vec3d SceneAt(float x, float y, float depth) const {
    const Vec3d right = Sum(eye_, (x + 0.5 - wide_ / 2.0) / scale_, right_);
    return Sum(Sum(right, (wide_ / 2.0 - y - 0.5) / scale_, up_), depth / scale_, towards_);
  }

  // Returns the strength of an edge's line: 255 on the edge.
  uint8_t EdgeAt(const Vec3d& point, const VoxelScene::Hit& hit) const {
    constexpr float kLeast = 8;  // samples; narrower cells show no edges
    if (cell_ < kLeast) return 0;
    const Vec3d at = Sum(point, -1, scene_.CenterOf(hit.cell));
    const float distance = static_cast<float>(rims_.Distance(at, hit.facet) * scale_),
                line = std::clamp(0.02F * cell_, 0.5F, 3.0F);
    return static_cast<uint8_t>(255 * Share(distance, line + 1, line) * Share(cell_, kLeast, 3 * kLeast));
  }

  // Returns the normal of the smooth surface.
  Vec3f NormalAt(int x, int y) const {
    const float here = smooth_[At(x, y)];
    const auto slope = [&](int dx, int dy) {
      const auto depth = [&](int sign) {
        const int sx = std::clamp(x + sign * dx, 0, wide_ - 1), sy = std::clamp(y + sign * dy, 0, wide_ - 1);
        const float there = smooth_[At(sx, sy)];
        return std::abs(there - here) < 16 ? there : here;
      };
      return (depth(1) - depth(-1)) / 4;
    };
    return Unit({-slope(2, 0), slope(0, 2), 1});
  }

  // Chooses the taps that search for occluders of the sky: eight directions, different for each sample of a pixel.
  void MakeTaps() {
    for (int phase = 0; phase < kSamples * kSamples; ++phase) {
      for (int d = 0; d < kDirections; ++d) {
        const float angle = (static_cast<float>(d) + static_cast<float>(phase) / (kSamples * kSamples)) *
                            (2 * std::numbers::pi_v<float> / kDirections);
        const auto direction = static_cast<size_t>(d);
        float distance = HollowReach();
        for (Ring& ring : rings_[static_cast<size_t>(phase)]) {
          ring.dx[direction] = static_cast<int>(std::lround(std::cos(angle) * distance));
          ring.dy[direction] = static_cast<int>(std::lround(std::sin(angle) * distance));
          ring.distance[direction] = distance;
          distance *= 0.55F;
        }
      }
    }
  }

  float HollowReach() const { return 0.07F * static_cast<float>(wide_); }

  // Returns the hidden share of the sky, by the height of the surroundings over the tangent plane. Where the surface is
  // seen edge-on, its tangent plane is not known well enough. The compiler makes vectors of the directions.
  float Occlusion(int x, int y, const Vec3f& normal) const {
    const float reach = HollowReach(), here = smooth_[At(x, y)], z = std::max(normal[2], 0.3F);
    std::array<float, kDirections> horizon{}, there{};
    const int margin = static_cast<int>(reach) + 1;
    const bool inside = std::min(x, y) >= margin && std::max(x, y) < wide_ - margin;
    for (const Ring& ring : rings_[PhaseOf(x, y)]) {
      for (size_t d = 0; d < kDirections; ++d) {
        const int sx = x + ring.dx[d], sy = y + ring.dy[d];
        const bool known = inside || (sx >= 0 && sy >= 0 && sx < wide_ && sy < wide_);
        there[d] = known ? smooth_[At(sx, sy)] : kNoDepth;
      }
      for (size_t d = 0; d < kDirections; ++d) {
        const float dx = static_cast<float>(ring.dx[d]), dy = static_cast<float>(ring.dy[d]);
        const float rise = there[d] - (here - (normal[0] * dx - normal[1] * dy) / z);
        const float sine = rise / std::sqrt(rise * rise + ring.distance[d] * ring.distance[d]);
        const float hidden = Share(sine, 0.08F, 1) * Share(rise, 3 * reach, reach);
        horizon[d] = rise > 0 && hidden > horizon[d] ? hidden : horizon[d];
      }
    }
    float sum = 0;
    for (const float each : horizon) sum += each;
    return sum / kDirections * Share(normal[2], 0.1F, 0.5F);
  }

  // Returns whether the light reaches the surface of the sample. A point `raise` above the surface stands for it, so
  // that small cells do not shade each other.
  bool Lit(int x, int y, const Vec3f& normal, float raise) const {
    const Vec3d surface = SceneAt(static_cast<float>(x), static_cast<float>(y), depth_[At(x, y)]);
    const Vec3d above = Sum(surface, raise, ToScene(normal));
    const size_t phase = PhaseOf(x, y);
    const double reach = fronts_[1 + phase]->Reach(above);
    return reach <= 0 || !scene_.Cast({above, ToScene(lights_[phase]), reach}).has_value();
  }

  static size_t PhaseOf(int x, int y) { return static_cast<size_t>(x % kSamples + kSamples * (y % kSamples)); }

  // The opacity is the share of samples that show a cell.
  void ShadePixel(int px, int py, uint8_t* pixel) const {
    Rgb sum{};
    int shown = 0;
    for (int s = 0; s < kSamples * kSamples; ++s) {
      const int x = px * kSamples + s % kSamples, y = py * kSamples + s / kSamples;
      if (depth_[At(x, y)] == kNoDepth) continue;
      const Rgb sample = Shade(x, y);
      for (size_t m = 0; m < 3; ++m) sum[m] += sample[m];
      ++shown;
    }
    if (shown == 0) return;
    for (size_t m = 0; m < 3; ++m) pixel[m] = LevelOf(sum[m] / static_cast<float>(shown));
    pixel[3] = static_cast<uint8_t>(255 * shown / (kSamples * kSamples));
  }

  Rgb ColorAt(size_t sample) const {
    if (colors_.empty()) return color_;
    const uint32_t color = colors_[sample];
    return {linear_[color >> 16], linear_[color >> 8 & 0xFF], linear_[color & 0xFF]};
  }

  Rgb Shade(int x, int y) const {
    const size_t at = At(x, y);
    const float facets = 0.2F * Share(cell_, 2, 4) + 0.65F * Share(cell_, 6, 24);
    const Vec3f smooth = NormalAt(x, y), &facet = normals_[facet_[at]];
    Vec3f normal;
    for (size_t m = 0; m < 3; ++m) normal[m] = facets * facet[m] + (1 - facets) * smooth[m];
    normal = Unit(normal);
    float key = std::max(0.0F, FloatDot(normal, lights_[PhaseOf(x, y)]));
    if (key > 0 && !Lit(x, y, smooth, cell_ < 12 ? 2.0F : 0.02F)) key = 0;
    const float sky = 0.5F + 0.5F * normal[1], open = 1 - Occlusion(x, y, smooth);
    const float fill = std::max(0.0F, FloatDot(normal, Unit({0.8F, 0.1F, 0.6F})));
    const float value = (open * open * (0.13F + 0.22F * sky + 0.16F * fill) + 1.05F * key) *
                        (1 - 0.45F * static_cast<float>(edge_[at]) / 255);
    Rgb color = ColorAt(at);
    for (float& component : color) component *= value;
    return color;
  }

  static constexpr int kDirections = 8, kSteps = 5;
  struct Ring {  // the taps of all directions at about one distance
    std::array<int, kDirections> dx, dy;
    std::array<float, kDirections> distance;
  };

  const VoxelScene& scene_;
  const Cancellation cancellation_;
  const FacetRims rims_;
  const int side_, wide_;            // pixels, samples
  const double filled_;              // share of the picture
  Vec3d right_, up_, towards_;       // the view frame's axes in the scene
  Vec3d eye_{};                      // in front of the middle of the picture
  double scale_ = 1;                 // samples per unit of the scene
  float cell_ = 1;                   // a cell's edge in samples
  std::array<float, 256> linear_{};  // of sRGB's levels
  Rgb color_;
  std::vector<Vec3f> normals_;         // of the cell's facets, view frame
  std::vector<float> depth_, smooth_;  // from the eye toward the viewer; kNoDepth without a cell; rows from the top
  std::array<Vec3f, kSamples * kSamples> lights_;  // toward the light, for each sample of a pixel
  std::array<std::optional<VoxelFront>, 1 + kSamples * kSamples> fronts_;  // toward the viewer, then toward each light
  std::vector<uint8_t> facet_, edge_;
  std::vector<uint32_t> colors_;  // of the samples; empty: all are color_
  std::array<std::array<Ring, kSteps>, kSamples * kSamples> rings_{};
};

// Returns the part of the picture that has cells, with a margin as on the side that they fill.
Image Cropped(const Image& picture) {
  const int margin = static_cast<int>(std::lround((1 - kFilledIfCropped) / 2 * picture.width()));
  int left = picture.width(), right = 0, top = picture.height(), bottom = 0;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      if (picture.At(x, y)[3] == 0) continue;
      left = std::min(left, x);
      right = std::max(right, x + 1);
      top = std::min(top, y);
      bottom = std::max(bottom, y + 1);
    }
  }
  if (right == 0) return picture;
  left = std::max(left - margin, 0);
  top = std::max(top - margin, 0);
  Image cropped(std::min(right + margin, picture.width()) - left, std::min(bottom + margin, picture.height()) - top);
  for (int y = 0; y < cropped.height(); ++y) {
    std::copy_n(picture.At(left, top + y), 4 * static_cast<size_t>(cropped.width()), cropped.At(0, y));
  }
  return cropped;
}

}  // namespace

int ShiftFor(const GridTransform& grid, double diagonal, const PictureOptions& options) {
  constexpr double kLeast = 0.35;  // least width of a cell in samples, if the diagonal fills the picture
  const double samples = kFilled * options.side * kSamples * grid.voxel_size / diagonal;
  return samples < kLeast ? static_cast<int>(std::ceil(std::log2(kLeast / samples))) : 0;
}

absl::StatusOr<std::string> DrawVoxels(const VoxelScene& scene, const PictureOptions& options) {
  Renderer renderer(scene, options);
  const Image picture = renderer.Draw();
  if (options.cancellation.cancelled()) return absl::CancelledError("cancelled");
  return FinishPicture(options.crop ? Cropped(picture) : picture, renderer.Scale(), options.style);
}

}  // namespace latvox::client
