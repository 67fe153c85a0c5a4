#include "client/tool/curve/svg_transform.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/tool/curve/scan.h"

namespace latvox::client {
namespace {

double Radians(double degrees) { return degrees * std::numbers::pi / 180; }

// std::cos is not 0 at the double nearest to a right angle.
Affine Rotation(double degrees) {
  const double quarters = std::remainder(degrees, 360) / 90;
  double cos = std::cos(Radians(degrees)), sin = std::sin(Radians(degrees));
  if (quarters == std::round(quarters)) {
    cos = std::round(cos);
    sin = std::round(sin);
  }
  return {cos, sin, -sin, cos, 0, 0};
}

Affine Skew(double along_x, double along_y) {
  return {1, std::tan(Radians(along_y)), std::tan(Radians(along_x)), 1, 0, 0};
}

// Returns nothing for an unknown name, or one that needs another number of numbers.
//   name   in lower case
std::optional<Affine> TransformOf(absl::string_view name, const std::vector<double>& n) {
  const bool one = n.size() == 1, one_or_two = one || n.size() == 2;
  if (name == "translate" && one_or_two) return Translation(n[0], one ? 0 : n[1]);
  if (name == "translatex" && one) return Translation(n[0], 0);
  if (name == "translatey" && one) return Translation(0, n[0]);
  if (name == "scale" && one_or_two) return Affine{n[0], 0, 0, n.back(), 0, 0};
  if (name == "scalex" && one) return Affine{n[0], 0, 0, 1, 0, 0};
  if (name == "scaley" && one) return Affine{1, 0, 0, n[0], 0, 0};
  if (name == "rotate" && one) return Rotation(n[0]);
  if (name == "rotate" && n.size() == 3) {
    return Compose(Compose(Translation(n[1], n[2]), Rotation(n[0])), Translation(-n[1], -n[2]));
  }
  if (name == "skew" && one_or_two) return Skew(n[0], one ? 0 : n[1]);
  if (name == "skewx" && one) return Skew(n[0], 0);
  if (name == "skewy" && one) return Skew(0, n[0]);
  if (name == "matrix" && n.size() == 6) return Affine{n[0], n[1], n[2], n[3], n[4], n[5]};
  return std::nullopt;
}

// Degrees in one.
constexpr std::pair<absl::string_view, double> kAngles[] = {
    {"", 1}, {"deg", 1}, {"grad", 0.9}, {"rad", 180 / std::numbers::pi}, {"turn", 360}};

bool ReadAngle(absl::string_view text, double& degrees) {
  if (!ReadDecimal(text, degrees)) return false;
  for (const auto& [unit, factor] : kAngles) {
    if (!absl::EqualsIgnoreCase(text, unit)) continue;
    degrees *= factor;
    return true;
  }
  return false;
}

// Returns the place of the parenthesis that closes the one before `text`, or npos.
size_t FindClose(absl::string_view text) {
  size_t depth = 0;
  for (size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '(') ++depth;
    if (text[at] == ')' && depth-- == 0) return at;
  }
  return absl::string_view::npos;
}

// Removes and returns what is before the first white space or comma outside of parentheses.
absl::string_view TakeArgument(absl::string_view& rest) {
  size_t depth = 0, at = 0;
  for (; at < rest.size(); ++at) {
    const char c = rest[at];
    if (depth == 0 && (c == ',' || absl::ascii_isspace(static_cast<unsigned char>(c)))) break;
    if (c == '(') ++depth;
    if (c == ')' && depth > 0) --depth;
  }
  const absl::string_view argument = rest.substr(0, at);
  rest.remove_prefix(at);
  return argument;
}

constexpr char kNoTransform[] =
    "does not begin with translate(x,y), scale(x,y), rotate(angle,x,y), skewX(angle), skewY(angle) or matrix(6), with "
    "px, in, cm, mm, Q, pt, pc and % of lengths, and deg, grad, rad and turn of angles";

// Reads the arguments of a transform as numbers, user units or degrees. Errors: INVALID_ARGUMENT with the reason.
absl::Status ReadArguments(absl::string_view name, absl::string_view rest, const Viewport& viewport,
                           std::vector<double>& numbers) {
  if (ParseNumbers(rest, numbers)) return absl::OkStatus();
  numbers.clear();
  const bool turns = name == "rotate";
  for (SkipSpace(rest); !rest.empty(); SkipSeparator(rest)) {
    absl::string_view argument = TakeArgument(rest);
    const size_t n = numbers.size();
    double& number = numbers.emplace_back();
    if (absl::StartsWith(name, "skew") || (turns && n == 0)) {
      if (!ReadAngle(argument, number)) return absl::InvalidArgumentError(kNoTransform);
    } else if (absl::StartsWith(name, "translate") || turns) {
      const auto length =
          ParseLength(argument, name == "translatey" || n % 2 == (turns ? 0 : 1) ? Along::kY : Along::kX, viewport);
      if (!length.ok()) {
        return absl::InvalidArgumentError(
            absl::StrCat("has the argument \"", argument, "\", which ", length.status().message()));
      }
      number = *length;
    } else if (!ReadDecimal(argument, number) || !argument.empty()) {
      return absl::InvalidArgumentError(kNoTransform);
    }
  }
  return absl::OkStatus();
}

// Checks the arguments of one transform of CSS.
//   name   in lower case
absl::Status CheckCssArguments(absl::string_view name, absl::string_view rest) {
  const bool has_units =
      absl::StartsWith(name, "translate") || absl::StartsWith(name, "rotate") || absl::StartsWith(name, "skew");
  size_t arguments = 0;
  for (bool more = true; more; ++arguments) {
    SkipSpace(rest);
    const absl::string_view argument = TakeArgument(rest);
    SkipSpace(rest);
    more = absl::ConsumePrefix(&rest, ",");
    if (argument.empty() || (!more && !rest.empty())) {
      return absl::InvalidArgumentError("and CSS demands one comma between arguments");
    }
    if (!has_units) continue;
    if (auto status = CheckUnit(argument); !status.ok()) return status;
  }
  if (name == "rotate" && arguments > 1) {
    return absl::InvalidArgumentError("and in CSS, rotate() has one angle; transform-origin is the center");
  }
  return absl::OkStatus();
}

}  // namespace

Affine Translation(double x, double y) { return {1, 0, 0, 1, x, y}; }

Affine Compose(const Affine& outer, const Affine& inner) {
  const auto linear = [&](double x, double y) { return Vec2d{outer.a * x + outer.c * y, outer.b * x + outer.d * y}; };
  const Vec2d i = linear(inner.a, inner.b), j = linear(inner.c, inner.d), o = outer({inner.e, inner.f});
  return {i[0], i[1], j[0], j[1], o[0], o[1]};
}

absl::StatusOr<Affine> ParseTransforms(absl::string_view text, const Viewport& viewport) {
  Affine transform;
  if (absl::EqualsIgnoreCase(absl::StripAsciiWhitespace(text), "none")) return transform;
  for (absl::string_view rest = text; SkipSeparator(rest), !rest.empty();) {
    const size_t open = std::min(rest.find('('), rest.size() - 1);
    const absl::string_view inside = rest.substr(open + 1);
    const size_t close = FindClose(inside);
    const std::string name = absl::AsciiStrToLower(absl::StripAsciiWhitespace(rest.substr(0, open)));
    std::vector<double> numbers;
    const auto refusal = [&](absl::string_view why) {
      return absl::InvalidArgumentError(absl::StrCat("transform \"", rest, "\" ", why));
    };
    if (close == absl::string_view::npos) return refusal(kNoTransform);
    if (auto status = ReadArguments(name, inside.substr(0, close), viewport, numbers); !status.ok()) {
      return refusal(status.message());
    }
    const auto one = TransformOf(name, numbers);
    if (!one) return refusal(kNoTransform);
    transform = Compose(transform, *one);
    rest = inside.substr(close + 1);
  }
  return transform;
}

absl::Status CheckCssTransforms(absl::string_view text) {
  for (absl::string_view rest = text; SkipSpace(rest), absl::StrContains(rest, '(');) {
    const size_t open = rest.find('(');
    const absl::string_view inside = rest.substr(open + 1);
    const size_t close = std::min(FindClose(inside), inside.size());
    const std::string name = absl::AsciiStrToLower(rest.substr(0, open));
    if (!std::all_of(name.begin(), name.end(), [](unsigned char c) { return absl::ascii_isalnum(c); })) {
      return absl::InvalidArgumentError("and CSS demands a name before each parenthesis, with no comma or space");
    }
    if (auto status = CheckCssArguments(name, inside.substr(0, close)); !status.ok()) return status;
    rest = inside.substr(std::min(close + 1, inside.size()));
  }
  return absl::OkStatus();
}

absl::Status CheckCssOrigin(absl::string_view text) {
  for (absl::string_view rest = text; SkipSpace(rest), !rest.empty();) {
    if (auto status = CheckUnit(TakeArgument(rest)); !status.ok()) return status;
    if (absl::StartsWith(rest, ",")) return absl::InvalidArgumentError("and CSS has no comma between lengths");
  }
  return absl::OkStatus();
}

absl::StatusOr<Vec2d> ParseOrigin(absl::string_view text, const Viewport& viewport) {
  std::vector<std::string> words;
  for (absl::string_view rest = absl::StripAsciiWhitespace(text); !rest.empty(); SkipSpace(rest)) {
    words.push_back(absl::AsciiStrToLower(TakeArgument(rest)));
    if (words.back().empty() || words.size() > 3) break;
  }
  const auto refusal = [&](absl::string_view why) {
    return absl::InvalidArgumentError(absl::StrCat("transform-origin \"", text, "\" ", why));
  };
  // A third one is a depth, which does not matter in the plane.
  if (words.empty() || words.size() > 3 || words.back().empty()) return refusal("is not one or two lengths");
  words.resize(2, "center");
  const auto is_of_y = [](absl::string_view word) { return word == "top" || word == "bottom"; };
  const auto is_of_x = [](absl::string_view word) { return word == "left" || word == "right"; };
  const auto is_word = [&](absl::string_view word) { return word == "center" || is_of_x(word) || is_of_y(word); };
  if (is_of_y(words[0]) || is_of_x(words[1])) {
    if (!is_word(words[0]) || !is_word(words[1]))
      return refusal("has a length or %, so the horizontal place comes first");
    std::swap(words[0], words[1]);
  }
  Vec2d origin{};
  for (size_t m = 0; m < 2; ++m) {
    std::string word = words[m];
    if (word == "center") word = "50%";
    if (m == 0 ? word == "left" : word == "top") word = "0";
    if (m == 0 ? word == "right" : word == "bottom") word = "100%";
    const auto length = ParseLength(word, m == 0 ? Along::kX : Along::kY, viewport);
    if (!length.ok()) return refusal(length.status().message());
    origin[m] = *length;
  }
  return origin;
}

bool ParseNumbers(absl::string_view text, std::vector<double>& numbers) {
  SkipSpace(text);
  while (!text.empty()) {
    if (!ReadDecimal(text, numbers.emplace_back())) return false;
    SkipSeparator(text);
  }
  return true;
}

}  // namespace latvox::client
