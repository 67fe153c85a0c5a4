#include "client/tool/output/lettering.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace latvox::client {
namespace {

constexpr double kHigh = 6;     // units of a digit's height
constexpr double kBetween = 2;  // units between characters
constexpr double kThick = 0.9;  // units of a line
constexpr double kBaseLine = 2;

// Lines through points of a grid. A point is two digits, x and y; the base line is y = 2. A space begins another line,
// and a line of one point is a dot.
struct Shape {
  char character;
  int width;
  const char* lines;
};

constexpr Shape kShapes[] = {
    {' ', 1, ""},
    {'0', 4, "123243473818070312"},
    {'1', 2, "072822"},
    {'2', 4, "07183847460242"},
    {'3', 4, "07183847463525 354443321203"},
    {'4', 4, "380444 3832"},
    {'5', 4, "480805354443321203"},
    {'6', 4, "3818070312324344351504"},
    {'7', 4, "084812"},
    {'8', 4, "15060718384746351504031232434435"},
    {'9', 4, "1232434738180706153546"},
    {'a', 4, "4536160503123243 4642"},
    {'b', 4, "0802 0516364543321203"},
    {'c', 4, "4536160503123243"},
    {'d', 4, "4842 4536160503123243"},
    {'e', 4, "04444536160503123243"},
    {'f', 3, "38281712 0626"},
    {'g', 4, "4641301001 4536160503123243"},
    {'h', 4, "0802 0516364542"},
    {'i', 0, "0602 08"},
    {'j', 1, "161100 18"},
    {'k', 3, "0802 360432"},
    {'l', 1, "080312"},
    {'m', 6, "0602 0516263532 3546566562"},
    {'n', 4, "0602 0516364542"},
    {'o', 4, "123243453616050312"},
    {'p', 4, "0600 0516364543321203"},
    {'q', 4, "4640 4536160503123243"},
    {'r', 3, "0602 051636"},
    {'s', 4, "45361605143443321203"},
    {'t', 3, "18132232 0636"},
    {'u', 4, "0603123243 4642"},
    {'v', 4, "062246"},
    {'w', 4, "0612263246"},
    {'x', 4, "0642 0246"},
    {'y', 4, "0622 4610"},
    {'z', 4, "06460242"},
    {'A', 4, "022842 1434"},
    {'B', 4, "020838474635 05354443 433202"},
    {'C', 4, "4738180703123243"},
    {'D', 4, "02082846442202"},
    {'E', 4, "48080242 0535"},
    {'F', 4, "480802 0535"},
    {'G', 4, "47381807031232434525"},
    {'H', 4, "0802 4842 0545"},
    {'I', 0, "0802"},
    {'J', 3, "3833221203"},
    {'K', 4, "0802 480542"},
    {'L', 4, "080242"},
    {'M', 4, "0208254842"},
    {'N', 4, "02084248"},
    {'O', 4, "123243473818070312"},
    {'P', 4, "02083847463505"},
    {'Q', 4, "123243473818070312 2442"},
    {'R', 4, "02083847463505 2542"},
    {'S', 4, "473818070615354443321203"},
    {'T', 4, "0848 2822"},
    {'U', 4, "080312324348"},
    {'V', 4, "082248"},
    {'W', 4, "0812263248"},
    {'X', 4, "0842 0248"},
    {'Y', 4, "082548 2522"},
    {'Z', 4, "08480242"},
    {'_', 4, "0141"},
    {'(', 1, "18070312"},
    {')', 1, "08171302"},
    {'/', 3, "0238"},
    {'.', 0, "02"},
    {',', 1, "1201"},
    {':', 0, "02 05"},
    {'-', 3, "0535"},
    {'+', 4, "0545 2723"},
    {'#', 4, "1218 3238 0444 0646"},
};

constexpr Shape kOther = {0, 4, "0208484202"};

// Calls visit(shape) for each character of a UTF-8 text.
template <class Visit>
void ForEachShape(absl::string_view text, const Visit& visit) {
  for (const char character : text) {
    if ((static_cast<unsigned char>(character) & 0xC0) == 0x80) continue;  // within a character
    const auto* const found = std::find_if(std::begin(kShapes), std::end(kShapes),
                                           [character](const Shape& shape) { return shape.character == character; });
    visit(found == std::end(kShapes) ? kOther : *found);
  }
}

struct Line {
  double ax, ay, bx, by;  // pixels
};

// Returns the lines of a shape whose left end of the base line is at (x, y).
std::vector<Line> LinesOf(const Shape& shape, double x, double y, double unit) {
  std::vector<Line> lines;
  bool begins = true;
  double last_x = 0, last_y = 0;
  for (const char* at = shape.lines; *at != '\0';) {
    if (*at == ' ') {
      begins = true;
      ++at;
      continue;
    }
    const double next_x = x + (at[0] - '0') * unit, next_y = y - (at[1] - '0' - kBaseLine) * unit;
    const bool is_dot = begins && (at[2] == ' ' || at[2] == '\0');
    if (!begins || is_dot) lines.push_back({is_dot ? next_x : last_x, is_dot ? next_y : last_y, next_x, next_y});
    begins = false;
    last_x = next_x;
    last_y = next_y;
    at += 2;
  }
  return lines;
}

double DistanceTo(const Line& line, double x, double y) {
  const double dx = line.bx - line.ax, dy = line.by - line.ay, square = dx * dx + dy * dy;
  const double along = square > 0 ? std::clamp(((x - line.ax) * dx + (y - line.ay) * dy) / square, 0.0, 1.0) : 0;
  return std::hypot(x - line.ax - along * dx, y - line.ay - along * dy);
}

void Draw(const Shape& shape, double left, double base, double unit, const Rgb8& color, Image& image) {
  const std::vector<Line> lines = LinesOf(shape, left, base, unit);
  const double half = std::max(0.5, kThick * unit / 2), margin = half + 1;
  const auto within = [](double x, int size) { return std::clamp(static_cast<int>(std::floor(x)), 0, size); };
  for (int y = within(base - kHigh * unit - margin, image.height()),
           bottom = within(base + kBaseLine * unit + margin + 1, image.height());
       y < bottom; ++y) {
    for (int x = within(left - margin, image.width()),
             right = within(left + shape.width * unit + margin + 1, image.width());
         x < right; ++x) {
      double nearest = margin;
      for (const Line& line : lines) nearest = std::min(nearest, DistanceTo(line, x + 0.5, y + 0.5));
      image.PaintOver(x, y, color, static_cast<float>(std::clamp(half + 0.5 - nearest, 0.0, 1.0)));
    }
  }
}

}  // namespace

double LetteringWidth(absl::string_view text, double height) {
  double units = 0;
  ForEachShape(text, [&units](const Shape& shape) { units += shape.width + kBetween; });
  return units * height / kHigh;
}

void Letter(absl::string_view text, double x, double y, double height, const Rgb8& color, Image& image) {
  const double unit = height / kHigh;
  ForEachShape(text, [&](const Shape& shape) {
    Draw(shape, x, y, unit, color, image);
    x += (shape.width + kBetween) * unit;
  });
}

}  // namespace latvox::client
