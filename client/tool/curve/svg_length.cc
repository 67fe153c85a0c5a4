#include "client/tool/curve/svg_length.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/tool/curve/scan.h"

namespace latvox::client {
namespace {

// User units in one.
constexpr std::pair<absl::string_view, double> kUnits[] = {
    {"px", 1}, {"in", 96}, {"cm", 96 / 2.54}, {"mm", 96 / 25.4}, {"q", 96 / 101.6}, {"pt", 96.0 / 72}, {"pc", 16}};

constexpr char kNoLength[] =
    "is not a finite number, also of px, in, cm, mm, Q, pt, pc or %, or calc(), min(), max(), clamp() of these";
constexpr char kNoViewport[] = "needs a viewBox, or width and height, of the drawing";

// Each function removes what it reads, and returns nothing at anything else.
class LengthReader {
 public:
  LengthReader(Along along, const Viewport& viewport) : along_(along), viewport_(viewport) {}

  struct Quantity {
    double value = 0;
    bool is_length = false;
  };

  absl::StatusOr<Quantity> Read(absl::string_view text) {
    text = absl::StripAsciiWhitespace(text);
    const auto quantity = ReadFactor(text);
    if (!quantity || !text.empty() || !std::isfinite(quantity->value)) return absl::InvalidArgumentError(why_);
    return *quantity;
  }

 private:
  static char OperatorOf(absl::string_view rest) {
    SkipSpace(rest);
    return rest.empty() ? '\0' : rest[0];
  }

  // White space must be around + and -, which also begin a number.
  std::optional<Quantity> ReadSum(absl::string_view& rest) {
    auto sum = ReadProduct(rest);
    for (char sign = OperatorOf(rest); sum && (sign == '+' || sign == '-'); sign = OperatorOf(rest)) {
      if (!absl::ascii_isspace(static_cast<unsigned char>(rest[0]))) return std::nullopt;
      SkipSpace(rest);
      rest.remove_prefix(1);
      if (rest.empty() || !absl::ascii_isspace(static_cast<unsigned char>(rest[0]))) return std::nullopt;
      const auto other = ReadProduct(rest);
      if (!other || other->is_length != sum->is_length) return std::nullopt;
      sum->value += sign == '+' ? other->value : -other->value;
    }
    return sum;
  }

  std::optional<Quantity> ReadProduct(absl::string_view& rest) {
    SkipSpace(rest);
    auto product = ReadFactor(rest);
    for (char sign = OperatorOf(rest); product && (sign == '*' || sign == '/'); sign = OperatorOf(rest)) {
      SkipSpace(rest);
      rest.remove_prefix(1);
      SkipSpace(rest);
      const auto other = ReadFactor(rest);
      if (!other || (other->is_length && (sign == '/' || product->is_length))) return std::nullopt;
      product->value = sign == '*' ? product->value * other->value : product->value / other->value;
      product->is_length = product->is_length || other->is_length;
    }
    return product;
  }

  std::optional<Quantity> ReadFactor(absl::string_view& rest) {
    double number = 0;
    if (!ReadDecimal(rest, number)) return ReadFunction(rest);
    if (absl::ConsumePrefix(&rest, "%")) return PartOfViewport(number / 100);
    const std::string unit = ReadWord(rest);
    if (unit.empty()) return Quantity{number, false};
    for (const auto& [name, factor] : kUnits) {
      if (unit == name) return Quantity{number * factor, true};
    }
    return std::nullopt;
  }

  static std::string ReadWord(absl::string_view& rest) {
    size_t end = 0;
    while (end < rest.size() && absl::ascii_isalpha(static_cast<unsigned char>(rest[end]))) ++end;
    std::string word = absl::AsciiStrToLower(rest.substr(0, end));
    rest.remove_prefix(end);
    return word;
  }

  std::optional<Quantity> PartOfViewport(double part) {
    const auto& [width, height] = viewport_;
    if ((along_ != Along::kY && !width) || (along_ != Along::kX && !height)) {
      why_ = kNoViewport;
      return std::nullopt;
    }
    return Quantity{part * (along_ == Along::kX   ? *width
                            : along_ == Along::kY ? *height
                                                  : std::hypot(*width, *height) / std::numbers::sqrt2),
                    true};
  }

  // Reads calc() and the others, and, within one of them, parentheses alone.
  std::optional<Quantity> ReadFunction(absl::string_view& rest) {
    const std::string name = ReadWord(rest);
    if (depth_ == kMaxDepth || (name.empty() && depth_ == 0) || !absl::ConsumePrefix(&rest, "(")) return std::nullopt;
    ++depth_;
    std::vector<Quantity> all;
    do {
      const auto next = ReadSum(rest);
      if (!next || (!all.empty() && next->is_length != all[0].is_length)) return std::nullopt;
      all.push_back(*next);
      SkipSpace(rest);
    } while (absl::ConsumePrefix(&rest, ","));
    --depth_;
    if (!absl::ConsumePrefix(&rest, ")")) return std::nullopt;
    const auto is_less = [](const Quantity& a, const Quantity& b) { return a.value < b.value; };
    if (name == "min") return *std::min_element(all.begin(), all.end(), is_less);
    if (name == "max") return *std::max_element(all.begin(), all.end(), is_less);
    if (name == "clamp" && all.size() == 3) return std::max(all[0], std::min(all[1], all[2], is_less), is_less);
    return (name.empty() || name == "calc") && all.size() == 1 ? std::optional(all[0]) : std::nullopt;
  }

  static constexpr int kMaxDepth = 32;

  const Along along_;
  const Viewport& viewport_;
  const char* why_ = kNoLength;
  int depth_ = 0;  // of parentheses
};

}  // namespace

absl::StatusOr<double> ParseLength(absl::string_view text, Along along, const Viewport& viewport) {
  const auto quantity = LengthReader(along, viewport).Read(text);
  if (!quantity.ok()) return quantity.status();
  return quantity->value;
}

absl::Status CheckUnit(absl::string_view text) {
  text = absl::StripAsciiWhitespace(text);
  double number = 0;
  absl::string_view rest = text;
  if (ReadDecimal(rest, number) && rest.empty() && number == 0) return absl::OkStatus();
  const auto quantity = LengthReader(Along::kBoth, {.width = 1, .height = 1}).Read(text);
  if (!quantity.ok() || quantity->is_length) return absl::OkStatus();
  return absl::InvalidArgumentError("and CSS demands a unit, such as px or deg");
}

absl::Status ReadLength(const pugi::xml_node& node, const char* name, Along along, const Viewport& viewport,
                        double& value) {
  const pugi::xml_attribute attribute = node.attribute(name);
  if (!attribute) return absl::OkStatus();
  const auto length = ParseLength(attribute.value(), along, viewport);
  if (!length.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(name, " \"", attribute.value(), "\" ", length.status().message()));
  }
  value = *length;
  return absl::OkStatus();
}

}  // namespace latvox::client
