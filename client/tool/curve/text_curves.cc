#include "client/tool/curve/text_curves.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/tool/curve/scan.h"

namespace latvox::client {
namespace {

// Reads "x,y" off the front, up to white space or the end.
bool ReadPoint(absl::string_view& rest, Vec2d& point) {
  if (!ReadDecimal(rest, point[0]) || rest.empty() || rest[0] != ',') return false;
  rest.remove_prefix(1);
  return ReadDecimal(rest, point[1]) && (rest.empty() || absl::ascii_isspace(static_cast<unsigned char>(rest[0])));
}

absl::StatusOr<Polyline> ParseLine(absl::string_view rest) {
  Polyline polyline;
  for (SkipSpace(rest); !rest.empty(); SkipSpace(rest)) {
    const absl::string_view word = rest;
    if (polyline.closed) return absl::InvalidArgumentError(absl::StrCat("\"", Shown(word), "\" after the closing z"));
    if (Shown(word) == "z" || Shown(word) == "Z") {
      if (polyline.points.empty()) return absl::InvalidArgumentError("a closing z without points");
      polyline.closed = true;
      rest.remove_prefix(1);
      continue;
    }
    if (Vec2d point; ReadPoint(rest, point)) {
      polyline.points.push_back(point);
    } else {
      return absl::InvalidArgumentError(absl::StrCat("\"", Shown(word), "\" is not a point x,y of finite numbers"));
    }
  }
  return polyline;
}

}  // namespace

absl::StatusOr<std::vector<Polyline>> ParseText(absl::string_view text) {
  std::vector<Polyline> polylines;
  size_t number = 0;
  for (const absl::string_view line : absl::StrSplit(text, '\n')) {
    ++number;
    auto polyline = ParseLine(line.substr(0, line.find('#')));
    if (!polyline.ok()) {
      return absl::InvalidArgumentError(absl::StrCat("line ", number, ": ", polyline.status().message()));
    }
    if (!polyline->points.empty()) polylines.push_back(*std::move(polyline));
  }
  return polylines;
}

}  // namespace latvox::client
