#include "client/tool/output/picture.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "client/internal/vec3.h"
#include "client/tool/output/beam.h"
#include "client/tool/output/depth_blur.h"
#include "client/tool/output/facet_rims.h"
#include "client/tool/output/gamma.h"
#include "client/tool/output/hollows.h"
#include "client/tool/output/share.h"
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

// Turns a direction from y up to another up axis. x stays on the right if z is up.
Vec3d FromYUp(const Vec3d& v, UpAxis up) {
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
        hollows_(options.side * kSamples),
        side_(options.side),
        wide_(options.side * kSamples),
        filled_(options.crop ? kFilledIfCropped : kFilled) {
    const double a = options.azimuth * std::numbers::pi / 180, e = options.elevation * std::numbers::pi / 180;
    right_ = FromYUp({std::cos(a), 0, -std::sin(a)}, options.up);
    towards_ = FromYUp({std::cos(e) * std::sin(a), std::sin(e), std::cos(e) * std::cos(a)}, options.up);
    up_ = Cross(towards_, right_);
    for (size_t level = 0; level < linear_.size(); ++level) linear_[level] = IntensityOf(static_cast<uint8_t>(level));
    for (size_t m = 0; m < 3; ++m) color_[m] = linear_[options.color[m]];
    for (const VoxelScene::Facet& facet : scene.facets()) normals_.push_back(ToView(facet.normal));
    const size_t samples = static_cast<size_t>(wide_) * static_cast<size_t>(wide_);
    depth_.resize(samples, kNoDepth);
    facet_.resize(samples);
    edge_.resize(samples);
    if (scene.colored()) colors_.resize(samples);
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
    ForTiles(wide_, [this](const Tile& tile) { CastTile(tile); });
    if (cancellation_.cancelled()) return picture;
    smooth_ = SmoothDepth(depth_, wide_, std::clamp(static_cast<int>(2.0F * cell_), 2, 32));
    ForTiles(side_, [&](const Tile& tile) {
      Beams beams;
      for (size_t phase = 0; phase < beams.size(); ++phase) beams[phase].emplace(scene_, ToScene(lights_[phase]));
      for (int y = tile.top; y < tile.bottom; ++y) {
        for (int x = tile.left; x < tile.right; ++x) ShadePixel(x, y, beams, picture.At(x, y));
      }
    });
    return picture;
  }

  // Returns the pixels of the picture per unit of the world.
  double Scale() const { return scale_ / kSamples / scene_.cell_size(); }

 private:
  using Beams = std::array<std::optional<VoxelScene::Beam>, kSamples * kSamples>;  // toward each light

  struct Tile {
    int left, top, right, bottom;
  };

  // Calls work(tile) for the tiles of a square. The voxels that the samples of a tile read stay in the cache.
  template <class Work>
  void ForTiles(int wide, const Work& work) const {
    constexpr int kTile = 64;
    const int count = (wide + kTile - 1) / kTile;
    tbb::parallel_for(0, count * count, [&](int n) {
      const int left = n % count * kTile, top = n / count * kTile;
      if (!cancellation_.cancelled()) work(Tile{left, top, std::min(left + kTile, wide), std::min(top + kTile, wide)});
    });
  }

  Vec3f ToView(const Vec3d& v) const {
    return {static_cast<float>(Dot3(v, right_)), static_cast<float>(Dot3(v, up_)),
            static_cast<float>(Dot3(v, towards_))};
  }
  static double Dot3(const Vec3d& a, const Vec3d& b) { return latvox::client::Dot(a, b); }
  Vec3d ToScene(const Vec3f& v) const { return Sum(Sum(Sum({}, v[0], right_), v[1], up_), v[2], towards_); }

  size_t At(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(wide_) + static_cast<size_t>(x); }

  Vec3d ToFrame(const Vec3d& at) const { return {Dot3(at, right_), Dot3(at, up_), Dot3(at, towards_)}; }

  void Frame() {
    constexpr double kFar = std::numeric_limits<double>::max(), kSlack = 1e-3;
    Vec3d low = {kFar, kFar, kFar}, high = {-kFar, -kFar, -kFar}, reach{};
    for (const Vec3d& corner : scene_.cell_corners()) {
      const Vec3f view = ToView(corner);
      for (size_t m = 0; m < 3; ++m) reach[m] = std::max(reach[m], double{view[m]});
    }
    Vec3d half{};  // of the box of a brick's centers
    for (const Vec3d& axis : {scene_.CenterOf({1, 0, 0}), scene_.CenterOf({0, 1, 0}), scene_.CenterOf({0, 0, 1})}) {
      for (size_t m = 0; m < 3; ++m) half[m] += 3.5 * std::abs(ToFrame(axis)[m]);
    }
    scene_.ForEachOuterBrick([&](const Brick& brick) {
      const auto& [i, j, k] = brick.brick_ijk;
      const Vec3d first = ToFrame(scene_.CenterOf({8 * i, 8 * j, 8 * k}));
      const Vec3d last = ToFrame(scene_.CenterOf({8 * i + 7, 8 * j + 7, 8 * k + 7}));
      bool within = true;
      for (size_t m = 0; m < 3; ++m) {
        const double middle = (first[m] + last[m]) / 2, room = half[m] + kSlack;
        within = within && middle - room >= low[m] && middle + room <= high[m];
      }
      if (within) return;
      ForEachVoxel(brick, [&](const Vec3i& cell) {
        const Vec3d view = ToFrame(scene_.CenterOf(cell));
        for (size_t m = 0; m < 3; ++m) {
          low[m] = std::min(low[m], view[m]);
          high[m] = std::max(high[m], view[m]);
        }
      });
    });
    if (scene_.empty()) low = high = {};
    scale_ = filled_ * wide_ / (std::max(high[0] - low[0] + 2 * reach[0], high[1] - low[1] + 2 * reach[1]));
    const Vec3f middle = {static_cast<float>((low[0] + high[0]) / 2), static_cast<float>((low[1] + high[1]) / 2),
                          static_cast<float>(high[2] + reach[2] + 1)};
    eye_ = ToScene(middle);
    cell_ = static_cast<float>(scale_);
  }

  void MakeFronts() {
    std::vector<VoxelFront::View> views = {{towards_, 1}};
    for (const Vec3f& light : lights_) views.push_back({ToScene(light), 2});
    fronts_ = VoxelFront::Of(scene_, views, cancellation_);
  }

  void CastTile(const Tile& tile) {
    VoxelScene::Beam beam(scene_, {-towards_[0], -towards_[1], -towards_[2]});
    for (int y = tile.top; y < tile.bottom; ++y) {
      for (int x = tile.left; x < tile.right; ++x) CastSample(x, y, beam);
    }
  }

  void CastSample(int x, int y, VoxelScene::Beam& beam) {
    const Vec3d eye = SceneAt(static_cast<float>(x), static_cast<float>(y), 0);
    const double front = fronts_.front().Reach(eye);
    if (!std::isfinite(front)) return;
    const Vec3d from = Sum(eye, front, towards_);
    const auto hit = beam.Cast(from);
    if (!hit) return;
    depth_[At(x, y)] = static_cast<float>((front - hit->t) * scale_);
    facet_[At(x, y)] = static_cast<uint8_t>(hit->facet);
    edge_[At(x, y)] = EdgeAt(Sum(from, -hit->t, towards_), *hit);
    if (!colors_.empty()) colors_[At(x, y)] = scene_.ColorOf(hit->cell);
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
    return static_cast<uint8_t>(255 * ShareOf(distance, line + 1, line) * ShareOf(cell_, kLeast, 3 * kLeast));
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

  // Returns whether the light reaches the surface of the sample. A point `raise` above the surface stands for it, so
  // that small cells do not shade each other.
  bool Lit(int x, int y, const Vec3f& normal, float raise, Beams& beams) const {
    const Vec3d surface = SceneAt(static_cast<float>(x), static_cast<float>(y), depth_[At(x, y)]);
    const Vec3d above = Sum(surface, raise, ToScene(normal));
    const size_t phase = PhaseOf(x, y);
    const double reach = fronts_[1 + phase].Reach(above);
    return reach <= 0 || !beams[phase]->Cast(above, reach).has_value();
  }

  static size_t PhaseOf(int x, int y) { return static_cast<size_t>(x % kSamples + kSamples * (y % kSamples)); }

  // The opacity is the share of samples that show a cell.
  void ShadePixel(int px, int py, Beams& beams, uint8_t* pixel) const {
    Rgb sum{};
    int shown = 0;
    for (int s = 0; s < kSamples * kSamples; ++s) {
      const int x = px * kSamples + s % kSamples, y = py * kSamples + s / kSamples;
      if (depth_[At(x, y)] == kNoDepth) continue;
      const Rgb sample = Shade(x, y, beams);
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

  Rgb Shade(int x, int y, Beams& beams) const {
    const size_t at = At(x, y);
    const float facets = 0.2F * ShareOf(cell_, 2, 4) + 0.65F * ShareOf(cell_, 6, 24);
    const Vec3f smooth = NormalAt(x, y), &facet = normals_[facet_[at]];
    Vec3f normal;
    for (size_t m = 0; m < 3; ++m) normal[m] = facets * facet[m] + (1 - facets) * smooth[m];
    normal = Unit(normal);
    float key = std::max(0.0F, FloatDot(normal, lights_[PhaseOf(x, y)]));
    if (key > 0 && !Lit(x, y, smooth, cell_ < 12 ? 2.0F : 0.02F, beams)) key = 0;
    const float sky = 0.5F + 0.5F * normal[1], open = 1 - hollows_.Share(smooth_, x, y, smooth);
    const float fill = std::max(0.0F, FloatDot(normal, Unit({0.8F, 0.1F, 0.6F})));
    const float value = (open * open * (0.13F + 0.22F * sky + 0.16F * fill) + 1.05F * key) *
                        (1 - 0.45F * static_cast<float>(edge_[at]) / 255);
    Rgb color = ColorAt(at);
    for (float& component : color) component *= value;
    return color;
  }

  const VoxelScene& scene_;
  const Cancellation cancellation_;
  const FacetRims rims_;
  const Hollows hollows_;
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
  std::vector<VoxelFront> fronts_;                 // toward the viewer, then toward each light
  std::vector<uint8_t> facet_, edge_;
  std::vector<uint32_t> colors_;  // of the samples; empty: all are color_
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
