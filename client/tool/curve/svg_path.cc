#include "client/tool/curve/svg_path.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "client/tool/curve/scan.h"
#include "client/tool/curve/svg_arc.h"

namespace latvox::client {
namespace {

class PathReader {
 public:
  PathReader(absl::string_view data, std::vector<Outline>& outlines) : rest_(data), outlines_(outlines) {}

  absl::Status Read() {
    SkipSpace(rest_);
    if (!rest_.empty() && rest_[0] != 'M' && rest_[0] != 'm') return NotExpected("M at the beginning of a path");
    while (!rest_.empty()) {
      const char command = rest_[0];
      if (!absl::ascii_isalpha(static_cast<unsigned char>(command))) return NotExpected("a command");
      rest_.remove_prefix(1);
      if (absl::Status status = Run(command); !status.ok()) return status;
      SkipSpace(rest_);
    }
    End(/*closed=*/false);
    return absl::OkStatus();
  }

 private:
  absl::Status NotExpected(absl::string_view what) const {
    return absl::InvalidArgumentError(
        rest_.empty() ? absl::StrCat("path data ends where ", what, " is expected")
                      : absl::StrCat("path data has \"", Shown(rest_), "\" where ", what, " is expected"));
  }

  absl::Status Run(char command) {
    const bool relative = absl::ascii_islower(static_cast<unsigned char>(command));
    switch (absl::ascii_toupper(static_cast<unsigned char>(command))) {
      case 'M':
        return MoveTo(relative);
      case 'L':
        return Repeat([&] { return CurveTo(1, relative); });
      case 'H':
        return Repeat([&] { return AxisTo(0, relative); });
      case 'V':
        return Repeat([&] { return AxisTo(1, relative); });
      case 'C':
        return Repeat([&] { return CurveTo(3, relative); });
      case 'Q':
        return Repeat([&] { return CurveTo(2, relative); });
      case 'S':
        return Repeat([&] { return SmoothTo(3, relative); });
      case 'T':
        return Repeat([&] { return SmoothTo(2, relative); });
      case 'A':
        return Repeat([&] { return ArcTo(relative); });
      case 'Z':
        End(/*closed=*/true);
        return absl::OkStatus();
      default:
        return absl::InvalidArgumentError(
            absl::StrCat("path command \"", std::string(1, command), "\" is not one of M L H V Z C S Q T A"));
    }
  }

  // Reads a command's arguments once, and again while numbers follow.
  template <class Step>
  absl::Status Repeat(const Step& step) {
    do {
      if (absl::Status status = step(); !status.ok()) return status;
      SkipSeparator(rest_);
    } while (!rest_.empty() && !absl::ascii_isalpha(static_cast<unsigned char>(rest_[0])));
    return absl::OkStatus();
  }

  absl::Status ReadCoordinate(double& value) {
    SkipSeparator(rest_);
    return ReadDecimal(rest_, value) ? absl::OkStatus() : NotExpected("a finite number");
  }

  absl::Status ReadPoint(bool relative, Vec2d& point) {
    for (size_t m = 0; m < 2; ++m) {
      if (absl::Status status = ReadCoordinate(point[m]); !status.ok()) return status;
      if (relative) point[m] += current_[m];
    }
    return absl::OkStatus();
  }

  // Further points are lines.
  absl::Status MoveTo(bool relative) {
    End(/*closed=*/false);
    Vec2d point;
    if (absl::Status status = ReadPoint(relative, point); !status.ok()) return status;
    outline_.start = current_ = point;
    SkipSeparator(rest_);
    if (rest_.empty() || absl::ascii_isalpha(static_cast<unsigned char>(rest_[0]))) return absl::OkStatus();
    return Repeat([&] { return CurveTo(1, relative); });
  }

  absl::Status CurveTo(size_t degree, bool relative) { return CurveFrom({degree, {}}, 0, relative); }

  // The first control point mirrors the last one of a curve of this degree. After anything else it is the start.
  absl::Status SmoothTo(size_t degree, bool relative) {
    OutlinePiece piece{degree, {current_}};
    if (!outline_.pieces.empty() && outline_.pieces.back().degree == degree && !after_arc_) {
      const Vec2d& last = outline_.pieces.back().control[degree - 2];
      for (size_t m = 0; m < 2; ++m) piece.control[0][m] = 2 * current_[m] - last[m];
    }
    return CurveFrom(piece, 1, relative);
  }

  // Reads the control points from the n-th on.
  absl::Status CurveFrom(OutlinePiece piece, size_t n, bool relative) {
    for (; n < piece.degree; ++n) {
      if (absl::Status status = ReadPoint(relative, piece.control[n]); !status.ok()) return status;
    }
    Append(piece);
    return absl::OkStatus();
  }

  absl::Status AxisTo(size_t axis, bool relative) {
    double value = 0;
    if (absl::Status status = ReadCoordinate(value); !status.ok()) return status;
    OutlinePiece piece{1, {current_}};
    piece.control[0][axis] = relative ? current_[axis] + value : value;
    Append(piece);
    return absl::OkStatus();
  }

  // Flags are one character, and may stand without a separator.
  absl::Status ReadFlag(bool& flag) {
    SkipSeparator(rest_);
    if (rest_.empty() || (rest_[0] != '0' && rest_[0] != '1')) return NotExpected("a flag, 0 or 1,");
    flag = rest_[0] == '1';
    rest_.remove_prefix(1);
    return absl::OkStatus();
  }

  absl::Status ArcTo(bool relative) {
    Arc arc;
    for (double* const number : {&arc.radii[0], &arc.radii[1], &arc.rotation}) {
      if (absl::Status status = ReadCoordinate(*number); !status.ok()) return status;
    }
    for (bool* const flag : {&arc.large, &arc.sweep}) {
      if (absl::Status status = ReadFlag(*flag); !status.ok()) return status;
    }
    if (absl::Status status = ReadPoint(relative, arc.end); !status.ok()) return status;
    AppendArc(current_, arc, outline_.pieces);
    current_ = arc.end;
    after_arc_ = true;
    return absl::OkStatus();
  }

  void Append(const OutlinePiece& piece) {
    outline_.pieces.push_back(piece);
    current_ = piece.end();
    after_arc_ = false;
  }

  // Commands after Z without an M begin at the start of this outline.
  void End(bool closed) {
    const Vec2d start = outline_.start;
    outline_.closed = closed;
    if (!outline_.pieces.empty()) outlines_.push_back(std::move(outline_));
    outline_ = {start, {}, false};
    if (closed) current_ = start;
  }

  absl::string_view rest_;
  std::vector<Outline>& outlines_;
  Outline outline_;
  Vec2d current_{};
  bool after_arc_ = false;  // the last pieces are an arc
};

// Returns |a - 2b + c|, the second difference of control points.
double Bend(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  return std::hypot(a[0] - 2 * b[0] + c[0], a[1] - 2 * b[1] + c[1]);
}

// Returns the number of chords. A chord over a share h of the parameter leaves the curve by at most h^2/8 times the
// largest second derivative. That is n(n-1) times the largest second difference of control points.
size_t CountChords(const Vec2d& start, const OutlinePiece& piece, double tolerance) {
  constexpr double kMost = 65536;
  const auto& [p, q, r] = piece.control;
  const double bound = piece.degree == 1   ? 0
                       : piece.degree == 2 ? 2 * Bend(start, p, q)
                                           : 6 * std::max(Bend(start, p, q), Bend(p, q, r));
  return static_cast<size_t>(std::clamp(std::ceil(std::sqrt(bound / (8 * tolerance))), 1.0, kMost));
}

// De Casteljau's algorithm.
Vec2d PointAt(const Vec2d& start, const OutlinePiece& piece, double t) {
  std::array<Vec2d, 4> points = {start, piece.control[0], piece.control[1], piece.control[2]};
  for (size_t left = piece.degree; left > 0; --left) {
    for (size_t n = 0; n < left; ++n) {
      for (size_t m = 0; m < 2; ++m) points[n][m] += t * (points[n + 1][m] - points[n][m]);
    }
  }
  return points[0];
}

}  // namespace

absl::Status ParsePathData(absl::string_view data, std::vector<Outline>& outlines) {
  return PathReader(data, outlines).Read();
}

Polyline Flatten(const Outline& outline, double tolerance) {
  Polyline polyline;
  polyline.closed = outline.closed;
  polyline.points.push_back(outline.start);
  for (const OutlinePiece& piece : outline.pieces) {
    const Vec2d start = polyline.points.back();
    const size_t chords = CountChords(start, piece, tolerance);
    for (size_t n = 1; n < chords; ++n) {
      polyline.points.push_back(PointAt(start, piece, static_cast<double>(n) / static_cast<double>(chords)));
    }
    polyline.points.push_back(piece.end());
  }
  return polyline;
}

}  // namespace latvox::client
