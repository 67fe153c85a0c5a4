#include "client/tool/output/picture_style.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "absl/strings/str_format.h"
#include "client/tool/output/gamma.h"
#include "client/tool/output/lettering.h"
#include "client/tool/output/png.h"

namespace latvox::client {
namespace {

// A part of the legend: its width, and a function that draws it from the left end of a base line on.
struct Item {
  double width;
  std::function<void(double x, double y, Image& image)> draw;
};

void FillBox(double left, double top, double right, double bottom, const Rgb8& color, Image& image) {
  const auto within = [](double x, int size) { return std::clamp(static_cast<int>(std::lround(x)), 0, size); };
  for (int y = within(top, image.height()); y < within(bottom, image.height()); ++y) {
    for (int x = within(left, image.width()); x < within(right, image.width()); ++x) image.PaintOver(x, y, color, 1);
  }
}

// Lays the legend of a picture out in rows.
class LegendStrip {
 public:
  LegendStrip(int width, const Rgb8& ink, double scale, const Legend& legend)
      : width_(width), high_(std::clamp(width / 56.0, 9.0, 40.0)), ink_(ink) {
    AddBar(scale);
    if (legend.is_ramp) {
      AddRamp(legend);
    } else {
      for (const LegendEntry& entry : legend.entries) AddEntry(entry);
    }
  }

  int Height() const { return static_cast<int>(std::ceil(LayOut(nullptr, 0))); }
  void Draw(int top, Image& image) const { LayOut(&image, top); }

 private:
  double TextWidth(const std::string& text) const { return LetteringWidth(text, high_); }

  // Returns the height.
  double LayOut(Image* image, double top) const {
    const double margin = 1.4 * high_, row = 2.2 * high_;
    double x = margin, base = top + 1.9 * high_;
    for (const Item& item : items_) {
      if (x > margin && x + item.width > width_ - margin) {
        x = margin;
        base += row;
      }
      if (image != nullptr) item.draw(x, base, *image);
      x += item.width + 2 * high_;
    }
    return base + margin - top;
  }

  void AddBar(double scale) {
    const double length = BarLength(width_ / 4.0 / scale), pixels = length * scale;
    const std::string text = absl::StrFormat("%g", length);
    items_.push_back({pixels + high_ / 2 + TextWidth(text), [=, this](double x, double y, Image& image) {
                        const double thick = std::max(1.0, high_ / 8), middle = y - high_ / 2;
                        FillBox(x, middle - thick / 2, x + pixels, middle + thick / 2, ink_, image);
                        for (const double end : {x, x + pixels - thick}) {
                          FillBox(end, y - 0.9 * high_, end + thick, y - 0.1 * high_, ink_, image);
                        }
                        Letter(text, x + pixels + high_ / 2, y, high_, ink_, image);
                      }});
  }

  void AddEntry(const LegendEntry& entry) {
    const double before = entry.color ? 1.5 * high_ : 0;
    items_.push_back({before + TextWidth(entry.text), [=, this](double x, double y, Image& image) {
                        if (entry.color) FillBox(x, y - high_, x + high_, y, ToRgb8(*entry.color), image);
                        Letter(entry.text, x + before, y, high_, ink_, image);
                      }});
  }

  // The first and the last text are beside the ramp.
  void AddRamp(const Legend& legend) {
    const std::string low = legend.entries.front().text, high = legend.entries.back().text;
    const double ramp = std::min(14 * high_, width_ / 3.0), before = TextWidth(low) + high_ / 2;
    items_.push_back({before + ramp + high_ / 2 + TextWidth(high), [=, this](double x, double y, Image& image) {
                        Letter(low, x, y, high_, ink_, image);
                        const double step = ramp / static_cast<double>(legend.entries.size());
                        for (size_t n = 0; n < legend.entries.size(); ++n) {
                          const double left = x + before + static_cast<double>(n) * step;
                          FillBox(left, y - high_, left + step, y, ToRgb8(*legend.entries[n].color), image);
                        }
                        Letter(high, x + before + ramp + high_ / 2, y, high_, ink_, image);
                      }});
  }

  const int width_;
  const double high_;  // of digits
  const Rgb8 ink_;
  std::vector<Item> items_;
};

// Returns a color that can be read before the background, whatever is behind a transparent one.
Rgb8 InkOn(const std::optional<Rgb8>& background) {
  if (!background) return {120, 120, 120};
  const auto& [red, green, blue] = *background;
  return 3 * red + 6 * green + blue > 1275 ? Rgb8{34, 34, 34} : Rgb8{235, 235, 235};
}

// Mixes the picture with the color behind it, as light mixes.
void PutBehind(const Rgb8& background, Image& image) {
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      uint8_t* const pixel = image.At(x, y);
      const float opacity = static_cast<float>(pixel[3]) / 255;
      if (pixel[3] == 255) continue;
      for (size_t m = 0; m < 3; ++m) {
        pixel[m] = pixel[3] == 0
                       ? background[m]
                       : LevelOf(IntensityOf(pixel[m]) * opacity + IntensityOf(background[m]) * (1 - opacity));
      }
      pixel[3] = 255;
    }
  }
}

}  // namespace

double BarLength(double most) {
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  for (const double times : {5.0, 2.0}) {
    if (times * power <= most) return times * power;
  }
  return power;
}

absl::StatusOr<std::string> FinishPicture(const Image& picture, double scale, const PictureStyle& style) {
  std::optional<LegendStrip> strip;
  if (style.legend) strip.emplace(picture.width(), InkOn(style.background), scale, *style.legend);
  Image image(picture.width(), picture.height() + (strip ? strip->Height() : 0));
  std::copy(picture.rgba().begin(), picture.rgba().end(), image.At(0, 0));
  if (style.background) PutBehind(*style.background, image);
  if (strip) strip->Draw(picture.height(), image);
  return EncodePng(image);
}

}  // namespace latvox::client
