#include "client/tool/output/pixel_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "client/tool/output/image.h"

namespace latvox::client {
namespace {

constexpr int kShortestSide = 64;
constexpr double kCellsFilled = 0.94;  // share of the picture
constexpr int kCellSamples = 3;        // per sample of the picture and axis

using CellColor = std::array<float, 4>;  // red, green, blue and opacity; multiplied by the opacity

constexpr CellColor kNoColor = {};
constexpr CellColor kRuling = {0.5F, 0.5F, 0.5F, 1};  // of empty cells, faint
constexpr CellColor kCellBorder = {0.33F, 0.47F, 0.66F, 1};
constexpr CellColor kCurve = {0.82F, 0.27F, 0.16F, 1};
constexpr CellColor kContour = {0, 0, 0, 1};

CellColor Mix(const CellColor& a, const CellColor& b, float share_of_b) {
  CellColor out;
  for (size_t m = 0; m < out.size(); ++m) out[m] = a[m] + (b[m] - a[m]) * share_of_b;
  return out;
}

CellColor ToRgb(uint32_t color) {
  const auto part = [color](int shift) { return static_cast<float>(color >> shift & 0xFF) / 255; };
  return {part(16), part(8), part(0), 1};
}

Vec2d operator-(const Vec2d& a, const Vec2d& b) { return {a[0] - b[0], a[1] - b[1]}; }
double PlaneDot(const Vec2d& a, const Vec2d& b) { return a[0] * b[0] + a[1] * b[1]; }

// The position of a world point among Voronoi cells.
struct CellSite {
  Vec2i cell, neighbor;  // the cell that holds the point, and the next nearest one
  double to_border;      // distance from the border of both
};

// Finds cells by a reduced basis u, v of the same lattice (Lagrange). It cuts every parallelogram into two triangles
// that are not obtuse. So the nearest lattice points are among the corners of the parallelogram around a point.
class CellFinder {
 public:
  explicit CellFinder(const PlaneTransform& grid) : origin_(grid.origin), u_(grid.basis.a), v_(grid.basis.b) {
    constexpr int kMaxSteps = 64;  // limit for a foreign basis; bases of core take a few
    for (int step = 0; step < kMaxSteps; ++step) {
      if (PlaneDot(u_, u_) > PlaneDot(v_, v_)) {
        std::swap(u_, v_);
        std::swap(u_ij_, v_ij_);
      }
      const double times = std::round(PlaneDot(u_, v_) / PlaneDot(u_, u_));
      if (times == 0 || !(std::abs(times) < 1 << 30)) break;
      for (size_t m = 0; m < 2; ++m) {
        v_[m] -= times * u_[m];
        v_ij_[m] -= static_cast<int64_t>(times) * u_ij_[m];
      }
    }
    det_ = u_[0] * v_[1] - u_[1] * v_[0];
  }

  // Returns a bound on the distance of a cell's points from its center.
  double reach() const { return (std::sqrt(PlaneDot(u_, u_)) + std::sqrt(PlaneDot(v_, v_))) / 2; }

  CellSite Find(const Vec2d& world) const {
    const Vec2d d = world - origin_;
    const double s = std::floor((d[0] * v_[1] - d[1] * v_[0]) / det_),
                 t = std::floor((u_[0] * d[1] - u_[1] * d[0]) / det_);
    std::array<Vec2d, 4> corner;  // relative to `world`
    std::array<double, 4> square;
    size_t nearest = 0;
    for (size_t n = 0; n < 4; ++n) {
      const double i = s + static_cast<double>(n & 1), j = t + static_cast<double>(n >> 1);
      for (size_t m = 0; m < 2; ++m) corner[n][m] = i * u_[m] + j * v_[m] - d[m];
      square[n] = PlaneDot(corner[n], corner[n]);
      if (square[n] < square[nearest]) nearest = n;
    }
    CellSite site{Index(s, t, nearest), {}, std::numeric_limits<double>::max()};
    for (size_t n = 0; n < 4; ++n) {
      if (n == nearest) continue;
      const Vec2d step = corner[n] - corner[nearest];
      const double to_border = (square[n] - square[nearest]) / (2 * std::sqrt(PlaneDot(step, step)));
      if (to_border < site.to_border) {
        site.to_border = to_border;
        site.neighbor = Index(s, t, n);
      }
    }
    return site;
  }

 private:
  Vec2i Index(double s, double t, size_t corner) const {
    const auto i = static_cast<int64_t>(s) + static_cast<int64_t>(corner & 1);
    const auto j = static_cast<int64_t>(t) + static_cast<int64_t>(corner >> 1);
    return {static_cast<int32_t>(i * u_ij_[0] + j * v_ij_[0]), static_cast<int32_t>(i * u_ij_[1] + j * v_ij_[1])};
  }

  Vec2d origin_, u_, v_;
  std::array<int64_t, 2> u_ij_ = {1, 0}, v_ij_ = {0, 1};  // u and v in lattice coordinates
  double det_ = 1;
};

class PixelPicture {
 public:
  PixelPicture(const PlaneTransform& grid, const std::vector<PictureCell>& cells, const PictureStyle& style)
      : grid_(grid), finder_(grid), style_(style) {
    if (const auto& paper = style.background) {
      for (size_t m = 0; m < 3; ++m) paper_[m] = static_cast<float>((*paper)[m]) / 255;
      paper_[3] = 1;
    }
    for (const PictureCell& cell : cells) cells_.emplace(cell.ij, cell);
  }

  // Chooses the part of the world that the picture shows.
  void Frame(const Vec2d& low, const Vec2d& high, bool y_down, int longer_side) {
    const Vec2d size = high - low;
    scale_ = kCellsFilled * longer_side / std::max({size[0], size[1], grid_.pixel_size});
    const double margin = (1 - kCellsFilled) * longer_side;
    const auto side = [&](double length) {
      return std::clamp(static_cast<int>(std::lround(length * scale_ + margin)), std::min(kShortestSide, longer_side),
                        longer_side);
    };
    width_ = side(size[0]);
    height_ = side(size[1]);
    for (size_t m = 0; m < 2; ++m) center_[m] = (low[m] + high[m]) / 2;
    up_ = y_down ? -1 : 1;
    cell_ = grid_.pixel_size * scale_;
    curve_.resize(static_cast<size_t>(width_) * static_cast<size_t>(height_));
  }

  // Returns a bound on the distance of a cell's points from its center.
  double reach() const { return finder_.reach(); }

  void DrawCurve(const Polyline& polyline) {
    const size_t count = polyline.points.size(), segments = polyline.closed || count == 1 ? count : count - 1;
    for (size_t n = 0; n < segments; ++n) {
      DrawSegment(ToPicture(polyline.points[n]), ToPicture(polyline.points[(n + 1) % count]));
    }
  }

  absl::StatusOr<std::string> Draw() const {
    Image picture(width_, height_);
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) {
        const CellColor color = Mix(ShadeCells(x, y), kCurve, curve_[At(x, y)]);
        uint8_t* const pixel = picture.At(x, y);
        pixel[3] = static_cast<uint8_t>(std::min(color[3], 1.0F) * 255 + 0.5F);
        for (size_t m = 0; m < 3 && pixel[3] != 0; ++m) {
          pixel[m] = static_cast<uint8_t>(std::min(color[m] / color[3], 1.0F) * 255 + 0.5F);
        }
      }
    }
    return FinishPicture(picture, scale_, style_);
  }

 private:
  size_t At(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }

  Vec2d ToPicture(const Vec2d& world) const {
    const Vec2d d = world - center_;
    return {width_ / 2.0 + d[0] * scale_, height_ / 2.0 - up_ * d[1] * scale_};
  }
  Vec2d ToWorld(double x, double y) const {
    return {center_[0] + (x - width_ / 2.0) / scale_, center_[1] - up_ * (y - height_ / 2.0) / scale_};
  }

  const PictureCell* CellAt(const Vec2i& ij) const {
    const auto found = cells_.find(ij);
    return found == cells_.end() ? nullptr : &found->second;
  }

  // Borders of plain cells are blue, those of other cells darker than the cell.
  static CellColor BorderOf(const PictureCell& cell) {
    return cell.color == kCellColor ? kCellBorder : Mix(ToRgb(cell.color), kContour, 0.35F);
  }

  // Draws contours always, borders of cells if cells are large enough, and borders of empty cells only at larger sizes.
  CellColor ShadeSample(const Vec2d& world) const {
    constexpr double kLeastBordered = 5, kLeastRuled = 9;
    const CellSite site = finder_.Find(world);
    const PictureCell* const cell = CellAt(site.cell);
    const double to_border = site.to_border * scale_, half_border = std::clamp(0.025 * cell_, 0.4, 1.0);
    if (to_border < 2 * half_border) {
      const PictureCell* const other = CellAt(site.neighbor);
      if (cell && other && cell->inside != other->inside) return kContour;
      const bool on_border = cell_ >= kLeastBordered && to_border < half_border;
      if (on_border && (cell || other)) return BorderOf(cell ? *cell : *other);
      if (on_border && cell_ >= kLeastRuled && style_.background) return Mix(paper_, kRuling, 0.15F);
    }
    return cell ? ToRgb(cell->color) : paper_;
  }

  CellColor ShadeCells(int x, int y) const {
    CellColor sum{};
    for (int s = 0; s < kCellSamples * kCellSamples; ++s) {
      const CellColor sample = ShadeSample(
          ToWorld(x + (s % kCellSamples + 0.5) / kCellSamples, y + (s / kCellSamples + 0.5) / kCellSamples));
      for (size_t m = 0; m < sum.size(); ++m) sum[m] += sample[m] / (kCellSamples * kCellSamples);
    }
    return sum;
  }

  // Scans lines across the main axis of the segment, so the cost is proportional to its length.
  void DrawSegment(const Vec2d& p, const Vec2d& q) {
    const Vec2d along = q - p;
    const size_t major = std::abs(along[0]) >= std::abs(along[1]) ? 0 : 1, minor = 1 - major;
    const double radius = std::clamp(0.07 * cell_, 0.6, 1.5), square = PlaneDot(along, along);
    const double reach = radius * std::sqrt(2) + 1;  // across, for the steepest slope
    const std::array<int, 2> size = {width_, height_};
    const auto first = [&](double x, size_t m) { return std::clamp(static_cast<int>(std::floor(x)), 0, size[m] - 1); };
    for (int a = first(std::min(p[major], q[major]) - reach, major),
             last = first(std::max(p[major], q[major]) + reach, major);
         a <= last; ++a) {
      const double share =
          square > 0 && along[major] != 0 ? std::clamp((a + 0.5 - p[major]) / along[major], 0.0, 1.0) : 0;
      const double across = p[minor] + share * along[minor];
      for (int b = first(across - reach, minor), end = first(across + reach, minor); b <= end; ++b) {
        const Vec2d at = major == 0 ? Vec2d{a + 0.5, b + 0.5} : Vec2d{b + 0.5, a + 0.5};
        const Vec2d d = at - p;
        const double t = square > 0 ? std::clamp(PlaneDot(d, along) / square, 0.0, 1.0) : 0;
        const double distance = std::hypot(d[0] - t * along[0], d[1] - t * along[1]);
        float& covered = curve_[At(static_cast<int>(at[0]), static_cast<int>(at[1]))];
        covered = std::max(covered, static_cast<float>(std::clamp(radius + 0.5 - distance, 0.0, 1.0)));
      }
    }
  }

  const PlaneTransform grid_;
  const CellFinder finder_;
  const PictureStyle style_;
  CellColor paper_ = kNoColor;
  absl::flat_hash_map<Vec2i, PictureCell> cells_;
  int width_ = 0, height_ = 0;
  double scale_ = 1, cell_ = 1, up_ = 1;  // samples per world unit; a pixel's edge in samples; -1: y is downwards
  Vec2d center_{};
  std::vector<float> curve_;  // covered share of each sample
};

}  // namespace

absl::StatusOr<std::string> DrawPixels(const Drawing& drawing, const Pixelization& pixelization) {
  std::vector<PictureCell> cells;
  for (const Vec2i& ij : pixelization.pixels) cells.push_back({ij});
  PixelPicture picture(pixelization.grid, cells, {});
  Vec2d low = drawing.polylines[0].points[0], high = low;
  const auto extend = [&](const Vec2d& p, double by) {
    for (size_t m = 0; m < 2; ++m) {
      low[m] = std::min(low[m], p[m] - by);
      high[m] = std::max(high[m], p[m] + by);
    }
  };
  for (const Polyline& polyline : drawing.polylines) {
    for (const Vec2d& p : polyline.points) extend(p, 0);
  }
  for (const Vec2i& ij : pixelization.pixels) extend(pixelization.grid.ToWorld(ij), picture.reach());
  picture.Frame(low, high, drawing.y_down, kPixelPictureSide);
  for (const Polyline& polyline : drawing.polylines) picture.DrawCurve(polyline);
  return picture.Draw();
}

absl::StatusOr<std::string> DrawCells(const PlaneTransform& grid, const std::vector<PictureCell>& cells,
                                      const Vec2d& low, const Vec2d& high, int longer_side, const PictureStyle& style) {
  PixelPicture picture(grid, cells, style);
  picture.Frame(low, high, /*y_down=*/false, longer_side);
  return picture.Draw();
}

}  // namespace latvox::client
