#include "client/output/picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "client/output/png.h"
#include "client/output/voxel_walk.h"

namespace latvox::client {
namespace {

constexpr float kNothing = -std::numeric_limits<float>::infinity();

// View frame: x to the right, y up, z towards the viewer; the world seen from azimuth 30 and elevation 22 degrees.
constexpr double kSinAzimuth = 0.5, kCosAzimuth = 0.8660254037844386;
constexpr double kSinElevation = 0.374606593415912, kCosElevation = 0.9271838545667874;

constexpr std::array<float, 3> kLight = {-0.42F, 0.62F, 0.66F};  // unit vector towards the light, view frame
constexpr std::array<float, 3> kBackground = {0.97F, 0.97F, 0.96F};
constexpr std::array<float, 3> kSurface = {0.33F, 0.47F, 0.66F};

Vec3d Rotate(const Vec3d& v) {
  const double x = kCosAzimuth * v[0] - kSinAzimuth * v[2];
  const double towards = kSinAzimuth * v[0] + kCosAzimuth * v[2];
  return {x, kCosElevation * v[1] - kSinElevation * towards, kSinElevation * v[1] + kCosElevation * towards};
}

double Dot(const Vec3d& a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

float Lambert(const std::array<float, 3>& normal) {
  return std::max(0.0F, normal[0] * kLight[0] + normal[1] * kLight[1] + normal[2] * kLight[2]);
}

}  // namespace

Picture::Picture(const GridTransform& grid, const Vec3d& low, const Vec3d& high)
    : grid_(grid), depth_(size_t{kWide} * kWide, kNothing), normal_(size_t{kWide} * kWide, 0) {
  Frame(low, high);
  MakeStamps();
}

Vec3d Picture::ToView(const Vec3d& world) const {
  const Vec3d view = Rotate({world[0] - center_[0], world[1] - center_[1], world[2] - center_[2]});
  return {view[0] * scale_, view[1] * scale_, view[2] * scale_};
}

void Picture::Frame(const Vec3d& low, const Vec3d& high) {
  constexpr double kFilled = 0.92;  // share of the picture
  for (size_t m = 0; m < 3; ++m) center_[m] = (low[m] + high[m]) / 2;
  double reach = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3d view =
        ToView({corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1], corner & 4 ? high[2] : low[2]});
    reach = std::max({reach, std::abs(view[0]), std::abs(view[1])});
  }
  reach += grid_.voxel_size;
  scale_ = kFilled * kWide / (2 * reach);
  voxel_samples_ = grid_.voxel_size * scale_;
}

// The cell is the intersection of the half-spaces p*w <= |w|^2 / 2 over lattice vectors w; along the line of sight
// through a sample it is the interval that none of them cuts off. Coefficients to 3 find the cell's faces for any basis
// that is not very skew; for one that is, cells look too large. Cells are half a sample wider on every side, so that
// rounding their centres to samples leaves no cracks.
void Picture::MakeStamps() {
  constexpr int kReach = 3;
  std::vector<Vec3d> vectors;
  for (int i = -kReach; i <= kReach; ++i) {
    for (int j = -kReach; j <= kReach; ++j) {
      for (int k = -kReach; k <= kReach; ++k) {
        if (i == 0 && j == 0 && k == 0) continue;
        Vec3d w{};
        for (size_t m = 0; m < 3; ++m)
          w[m] = (i * grid_.basis.a[m] + j * grid_.basis.b[m] + k * grid_.basis.c[m]) * scale_;
        vectors.push_back(Rotate(w));
      }
    }
  }
  for (const Vec3d& w : vectors) {
    const double length = std::sqrt(Dot(w, w));
    normals_.push_back(
        {static_cast<float>(w[0] / length), static_cast<float>(w[1] / length), static_cast<float>(w[2] / length)});
  }
  const double radius = (std::sqrt(Dot(grid_.basis.a, grid_.basis.a)) + std::sqrt(Dot(grid_.basis.b, grid_.basis.b)) +
                         std::sqrt(Dot(grid_.basis.c, grid_.basis.c))) /
                        2 * scale_;
  const int reach = static_cast<int>(std::min(radius + 1, double{kWide}));
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      double front = std::numeric_limits<double>::max(), back = std::numeric_limits<double>::lowest();
      size_t face = 0;
      for (size_t n = 0; n < vectors.size() && back <= front; ++n) {
        const Vec3d& w = vectors[n];
        const double square = Dot(w, w);
        const double room = square / 2 + std::sqrt(square) / 2 - w[0] * dx - w[1] * dy;
        if (std::abs(w[2]) <= 1e-9 * std::sqrt(square)) {
          if (room < 0) back = std::numeric_limits<double>::max();
        } else if (w[2] > 0 && room / w[2] < front) {
          front = room / w[2];
          face = n;
        } else if (w[2] < 0) {
          back = std::max(back, room / w[2]);
        }
      }
      if (back <= front) stamps_.push_back({dx, dy, static_cast<float>(front), static_cast<uint16_t>(face)});
    }
  }
}

void Picture::Draw(const Brick& brick) {
  ForEachVoxel(brick, [this](const Vec3i& ijk) { DrawVoxel(ijk); });
}

void Picture::DrawVoxel(const Vec3i& ijk) {
  const Vec3d view = ToView(grid_.ToWorld(ijk));
  // Negated, so that nothing beyond int or NaN gets through.
  if (!(std::abs(view[0]) < kWide && std::abs(view[1]) < kWide)) return;
  const int x = static_cast<int>(std::lround(kWide / 2 + view[0])),
            y = static_cast<int>(std::lround(kWide / 2 - view[1]));
  for (const Stamp& stamp : stamps_) {
    const int sx = x + stamp.dx, sy = y - stamp.dy;
    if (sx < 0 || sy < 0 || sx >= kWide || sy >= kWide) continue;
    const size_t at = static_cast<size_t>(sy) * kWide + static_cast<size_t>(sx);
    const float depth = static_cast<float>(view[2]) + stamp.depth;
    if (depth <= depth_[at]) continue;
    depth_[at] = depth;
    normal_[at] = stamp.normal;
  }
}

// The surface beneath the cells' facets: depth averaged over about two voxels, not across the edges of the shape.
std::vector<float> Picture::SmoothDepth() const {
  const int radius = std::clamp(static_cast<int>(1.5 * voxel_samples_), 2, 24);
  const float edge = 3.0F * static_cast<float>(radius);
  std::vector<float> in = depth_, out = depth_;
  for (const int step : {1, kWide}) {
    for (int y = 0; y < kWide; ++y) {
      for (int x = 0; x < kWide; ++x) {
        const int at = y * kWide + x;
        const float here = in[static_cast<size_t>(at)];
        if (here == kNothing) continue;
        const int along = step == 1 ? x : y;
        float sum = 0, weight = 0;
        for (int d = std::max(-radius, -along); d <= std::min(radius, kWide - 1 - along); ++d) {
          const float there = in[static_cast<size_t>(at + d * step)];
          if (!(std::abs(there - here) < edge)) continue;
          sum += there;
          weight += 1;
        }
        out[static_cast<size_t>(at)] = sum / weight;
      }
    }
    in = out;
  }
  return out;
}

// Facets where voxels are large enough to be seen, the smooth surface where they are not; hollows a little darker.
Picture::Rgb Picture::Shade(const std::vector<float>& smooth, int x, int y) const {
  const size_t at = static_cast<size_t>(y) * kWide + static_cast<size_t>(x);
  if (depth_[at] == kNothing) return kBackground;
  const auto slope = [&](int dx, int dy) {
    const auto depth = [&](int sign) {
      const int sx = std::clamp(x + sign * dx, 0, kWide - 1), sy = std::clamp(y + sign * dy, 0, kWide - 1);
      const float there = smooth[static_cast<size_t>(sy) * kWide + static_cast<size_t>(sx)];
      return std::abs(there - smooth[at]) < 12 ? there : smooth[at];
    };
    return (depth(1) - depth(-1)) / 4;
  };
  std::array<float, 3> normal = {-slope(2, 0), slope(0, 2), 1};
  const float length = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + 1);
  for (float& component : normal) component /= length;
  const float facet = std::clamp((static_cast<float>(voxel_samples_) - 4) / 16, 0.0F, 0.75F);
  const float light = facet * Lambert(normals_[normal_[at]]) + (1 - facet) * Lambert(normal);
  const float hollow = std::clamp((smooth[at] - depth_[at]) / static_cast<float>(voxel_samples_ + 1), 0.0F, 0.5F);
  const float value = (0.30F + 0.95F * light) * (1 - 0.5F * hollow);
  Rgb color;
  for (size_t m = 0; m < 3; ++m) {
    // Towards white where it is brightest.
    const float bright = std::max(0.0F, value - 0.85F);
    color[m] = std::clamp(kSurface[m] * value * 1.15F + bright * 0.9F, 0.0F, 1.0F);
  }
  return color;
}

absl::StatusOr<std::string> Picture::ToPng() const {
  const std::vector<float> smooth = SmoothDepth();
  std::vector<uint8_t> pixels;
  pixels.reserve(size_t{kSide} * kSide * 3);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      Rgb sum{};
      for (int s = 0; s < kSamples * kSamples; ++s) {
        const Rgb sample = Shade(smooth, x * kSamples + s % kSamples, y * kSamples + s / kSamples);
        for (size_t m = 0; m < 3; ++m) sum[m] += sample[m] / (kSamples * kSamples);
      }
      for (const float component : sum) pixels.push_back(static_cast<uint8_t>(component * 255 + 0.5F));
    }
  }
  return EncodePng(kSide, kSide, pixels);
}

}  // namespace latvox::client
