// Reading of drawings: exact results, and errors that name their place.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "absl/strings/str_format.h"
#include "client/tool/curve/curve_file.h"
#include "client/tool/curve/svg_curves.h"
#include "client/tool/curve/svg_path.h"
#include "client/tool/curve/text_curves.h"
#include "client/tool/output/pixel_output.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

Polyline Open(std::vector<Vec2d> points) { return {std::move(points), false}; }
Polyline Closed(std::vector<Vec2d> points) { return {std::move(points), true}; }

std::vector<Polyline> Text(absl::string_view text) {
  auto polylines = ParseText(text);
  EXPECT_TRUE(polylines.ok()) << polylines.status();
  return polylines.value_or(std::vector<Polyline>{});
}

std::vector<Polyline> Svg(absl::string_view elements) {
  auto polylines = ParseSvg(absl::StrCat("<svg>\n", elements, "\n</svg>"));
  EXPECT_TRUE(polylines.ok()) << polylines.status();
  return polylines.value_or(std::vector<Polyline>{});
}

std::string SvgError(absl::string_view elements) {
  const auto status = ParseSvg(absl::StrCat("<svg>\n", elements, "\n</svg>")).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << elements;
  return std::string{status.message()};
}

std::vector<Polyline> Path(const std::string& data) { return Svg("<path d=\"" + data + "\"/>"); }

TEST(TextCurves, EachLineIsAPolyline) {
  EXPECT_THAT(Text("0,0 1,-2.5\t+3e-1,.5 z\r\n"
                   "\n"
                   "  # a comment\n"
                   "1,2 # another\n"
                   "0.1,1e-400 7.,8 Z"),
              ElementsAre(Closed({{0, 0}, {1, -2.5}, {0.3, 0.5}}), Open({{1, 2}}), Closed({{0.1, 0}, {7, 8}})));
  EXPECT_THAT(Text(""), IsEmpty());
}

TEST(TextCurves, RefusalsNameLineAndText) {
  const auto refuses = [](const std::string& text, const std::string& says) {
    const auto status = ParseText(text).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_THAT(std::string(status.message()), HasSubstr(says));
  };
  refuses("0,0\n1;2\n", "line 2: \"1;2\"");
  refuses("0,0 1", "\"1\" is not a point");
  refuses("0, 0", "\"0,\" is not a point");
  refuses("1,2,3", "\"1,2,3\" is not a point");
  refuses("nan,0", "\"nan,0\"");
  refuses("0,inf", "\"0,inf\"");
  refuses("0,-1e999", "\"0,-1e999\"");
  refuses("+-1,0", "\"+-1,0\"");
  refuses("0x1,0", "\"0x1,0\"");
  refuses("z", "without points");
  refuses("1,2 z 3,4", "\"3,4\" after the closing z");
  refuses(std::string("1,2\0", 4), "is not a point");
}

TEST(SvgCurves, ReadsEveryShape) {
  EXPECT_THAT(Svg("<polyline points='0,0 1 2,3-4'/><polygon points=' 0 0,1 0 1 1 '/><line x2='3' y1='-1'/>"
                  "<rect x='1' y='2' width='3' height='4'/><rect width='0' height='1'/>"),
              ElementsAre(Open({{0, 0}, {1, 2}, {3, -4}}), Closed({{0, 0}, {1, 0}, {1, 1}}), Open({{0, -1}, {3, 0}}),
                          Closed({{1, 2}, {4, 2}, {4, 6}, {1, 6}})));
}

TEST(SvgCurves, ReadsPathsOfLines) {
  EXPECT_THAT(Path("M1 2L3,4 5 6"), ElementsAre(Open({{1, 2}, {3, 4}, {5, 6}})));
  EXPECT_THAT(Path("m1 2 3 4l-1-1"), ElementsAre(Open({{1, 2}, {4, 6}, {3, 5}})));
  EXPECT_THAT(Path("M0 0H2 3V4h-1v-.5.25z"),
              ElementsAre(Closed({{0, 0}, {2, 0}, {3, 0}, {3, 4}, {2, 4}, {2, 3.5}, {2, 3.75}})));
  EXPECT_THAT(Path("M1 1h1zm5 5h1M0 0M9 9V0"),
              ElementsAre(Closed({{1, 1}, {2, 1}}), Open({{6, 6}, {7, 6}}), Open({{9, 9}, {9, 0}})));
  EXPECT_THAT(Path("M1 1h1zv2"), ElementsAre(Closed({{1, 1}, {2, 1}}), Open({{1, 1}, {1, 3}})));
  EXPECT_THAT(Path(" "), IsEmpty());
}

TEST(SvgCurves, TransformsComposeFromTheOutside) {
  EXPECT_THAT(
      Svg("<g transform='translate(10) scale(2,3)'><g><line x2='1' y2='1' transform='translate(1,1)'/></g></g>"),
      ElementsAre(Open({{12, 3}, {14, 6}})));
  EXPECT_THAT(Svg("<line x1='1' y1='2' x2='3' y2='4' transform='matrix(0 1 -1 0 5 6), scale(2)'/>"),
              ElementsAre(Open({{1, 8}, {-3, 12}})));
}

TEST(SvgCurves, TurnsAndSkews) {
  const std::string line = "<line x1='1' y1='2' x2='3' y2='4' transform='";
  EXPECT_THAT(Svg(line + "rotate(90)'/>"), ElementsAre(Open({{-2, 1}, {-4, 3}})));
  EXPECT_THAT(Svg(line + "rotate(-180 1,2)'/>"), ElementsAre(Open({{1, 2}, {-1, 0}})));
  EXPECT_THAT(Svg(line + "rotate(450)'/>"), ElementsAre(Open({{-2, 1}, {-4, 3}})));
  EXPECT_NEAR(Svg(line + "rotate(30)'/>")[0].points[0][0], std::sqrt(0.75) - 1, 1e-15);
  EXPECT_NEAR(Svg(line + "skewX(45)'/>")[0].points[0][0], 3, 1e-15);
  EXPECT_NEAR(Svg(line + "skewY(45)'/>")[0].points[1][1], 7, 1e-15);
}

TEST(SvgCurves, ReadsLengthsInEveryUnit) {
  EXPECT_THAT(Svg("<line x1='1in' y1='3pc' x2='6pt' y2=' 5px'/>"), ElementsAre(Open({{96, 48}, {8, 5}})));
  const Polyline metric = Svg("<line x1='2.54cm' y1='25.4mm' x2='101.6Q' y2='101.6q'/>").at(0);
  for (const Vec2d& point : metric.points) {
    for (const double x : point) EXPECT_NEAR(x, 96, 1e-12);
  }
  const auto shares = [](absl::string_view root) {
    const auto lines = ParseSvg(absl::StrCat("<svg ", root, "><line x1='50%' y1='25%' x2='1' y2='1'/></svg>"));
    EXPECT_TRUE(lines.ok()) << lines.status();
    return lines->at(0).points[0];
  };
  EXPECT_EQ(shares("viewBox='7 7 20 40' width='5mm'"), (Vec2d{10, 10}));
  EXPECT_EQ(shares("width='30' height='8'"), (Vec2d{15, 2}));
}

TEST(SvgCurves, UsesElementsInTheirPlaces) {
  const std::string symbol = "<defs><g id='a' transform='scale(2)'><line id='b' x2='1'/></g></defs>";
  EXPECT_THAT(Svg(symbol + "<use href='#a' x='10'/><use xlink:href='#b' transform='translate(1,1)' y='2'/>"),
              ElementsAre(Open({{10, 0}, {12, 0}}), Open({{1, 3}, {2, 3}})));
  EXPECT_THAT(Svg("<symbol id='s' viewBox='0 0 10 10'><line x1='5' x2='10'/></symbol>"
                  "<use href='#s' width='20' height='40'/>"),
              ElementsAre(Open({{10, 10}, {20, 10}})));
  EXPECT_THAT(SvgError("<use href='#none'/>"), HasSubstr("<use> href \"#none\" is not #ID of an element"));
  EXPECT_THAT(SvgError("<use href='other.svg#a'/>"), HasSubstr("is not #ID"));
  EXPECT_THAT(SvgError("<g id='a'><use href='#a'/></g>"), HasSubstr("the limit is 256"));
  std::string doubled = "<line id='d0' x2='1'/>";  // 2^40 lines
  for (int n = 0; n < 40; ++n) {
    doubled += absl::StrFormat("<g id='d%d'><use href='#d%d'/><use href='#d%d'/></g>", n + 1, n, n);
  }
  EXPECT_THAT(SvgError("<defs>" + doubled + "</defs><use href='#d40'/>"), HasSubstr("the limit of 1000000 elements"));
}

TEST(SvgCurves, NestsDrawings) {
  const auto nested = [](absl::string_view attributes) {
    return Svg(absl::StrCat("<svg x='1' y='2' ", attributes, "><line x2='4' y2='2'/></svg>")).at(0);
  };
  EXPECT_EQ(nested(""), Open({{1, 2}, {5, 4}}));
  EXPECT_EQ(nested("width='8' height='8' viewBox='0 0 4 2'"), Open({{1, 4}, {9, 8}}));
  EXPECT_EQ(nested("width='8' height='8' viewBox='0 0 4 2' preserveAspectRatio='xMidYMin'"), Open({{1, 2}, {9, 6}}));
  EXPECT_EQ(nested("width='8' height='8' viewBox='0 0 4 2' preserveAspectRatio='xMaxYMid slice'"),
            Open({{-7, 2}, {9, 10}}));
  EXPECT_EQ(nested("width='8' height='8' viewBox='0 0 4 2' preserveAspectRatio='none'"), Open({{1, 2}, {9, 10}}));
  EXPECT_EQ(nested("width='8' height='8' viewBox='4 0 4 2'"), Open({{-7, 4}, {1, 8}}));
  EXPECT_THAT(Svg("<svg width='0'><line x2='1'/></svg>"), IsEmpty());
  EXPECT_THAT(SvgError("<svg viewBox='0 0 1 1'/>"), HasSubstr("<svg> needs width and height"));
  EXPECT_THAT(SvgError("<svg width='1' height='1' viewBox='0 0 0 1'/>"), HasSubstr("viewBox \"0 0 0 1\" is not"));
  EXPECT_THAT(SvgError("<svg width='-1'/>"), HasSubstr("has a negative size"));
}

TEST(SvgCurves, LeavesOutWhatIsHidden) {
  EXPECT_THAT(Svg("<g display='none'><line x2='1'/></g><g style='fill:red; display : none'><line x2='2'/></g>"
                  "<g style='display:inline'><line x2='3'/></g>"),
              ElementsAre(Open({{0, 0}, {3, 0}})));
  EXPECT_THAT(Svg("<switch><image requiredExtensions='x'/><line x2='1'/><line x2='2'/></switch>"
                  "<switch><line systemLanguage='de' x2='3'/><a><line x2='4'/></a></switch>"),
              ElementsAre(Open({{0, 0}, {1, 0}}), Open({{0, 0}, {4, 0}})));
}

// Returns the greatest distance of the points, and of the middles between them, from the unit circle.
double FromUnitCircle(const Polyline& polyline) {
  double greatest = 0;
  const size_t count = polyline.points.size();
  for (size_t n = 0; n + 1 < count + (polyline.closed ? 1 : 0); ++n) {
    const Vec2d &p = polyline.points[n], &q = polyline.points[(n + 1) % count];
    greatest = std::max({greatest, std::abs(std::hypot(p[0], p[1]) - 1),
                         std::abs(std::hypot((p[0] + q[0]) / 2, (p[1] + q[1]) / 2) - 1)});
  }
  return greatest;
}

TEST(SvgCurves, CirclesAndEllipsesStayWithinTheTolerance) {
  const double most = 1.01 * 2 * kFlatness;
  const Polyline circle = Svg("<circle r='1'/>").at(0);
  EXPECT_TRUE(circle.closed);
  EXPECT_EQ(circle.points[0], (Vec2d{1, 0}));
  EXPECT_LT(FromUnitCircle(circle), most);
  EXPECT_LT(
      FromUnitCircle(Svg("<ellipse cx='12' cy='6' rx='4' ry='2' transform='scale(.25 .5) translate(-12 -6)'/>")[0]),
      most);
  EXPECT_THAT(Svg("<circle/><ellipse rx='1' ry='0'/>"), IsEmpty());
  EXPECT_EQ(Svg("<ellipse rx='3'/>"), Svg("<circle r='3'/>"));
  EXPECT_THAT(SvgError("<circle r='-1'/>"), HasSubstr("<circle> has a negative radius"));
}

TEST(SvgCurves, ArcsTakeTheSideThatTheirFlagsSay) {
  const double half = std::sqrt(0.5), most = 1.01 * 2 * kFlatness;
  const auto arc = [&](const char* flags) {
    return Path(absl::StrFormat("M%.17g %.17gA1 1 30 %s %.17g %.17g", half, half, flags, -half, half)).at(0);
  };
  // Around the center (0, 0), or around (0, sqrt 2). y points down.
  EXPECT_LT(FromUnitCircle(arc("01")), most);
  EXPECT_LT(FromUnitCircle(arc("1,0")), most);
  const auto middle = [](const Polyline& polyline) { return polyline.points[polyline.points.size() / 2][1]; };
  EXPECT_NEAR(middle(arc("0 1")), 1, 1e-3);
  EXPECT_NEAR(middle(arc("1 0")), -1, 1e-3);
  EXPECT_NEAR(middle(arc("0 0")), std::sqrt(2) - 1, 1e-3);
  EXPECT_NEAR(middle(arc("1 1")), std::sqrt(2) + 1, 1e-3);
  EXPECT_EQ(arc("0 1").points.back(), (Vec2d{-half, half}));
  EXPECT_LT(FromUnitCircle(Path("M-1 0a.1.1 0 102 0").at(0)), most);  // radii grow
  EXPECT_THAT(Path("M0 0A0 1 0 0 0 2 3a1 1 0 0 0 0 0"), ElementsAre(Open({{0, 0}, {2, 3}})));
  EXPECT_THAT(SvgError("<path d='M0 0A1 1 0 2 0 1 1'/>"), HasSubstr("has \"2\" where a flag, 0 or 1, is expected"));
}

TEST(SvgCurves, RoundCornersAreArcs) {
  EXPECT_EQ(Svg("<rect x='1' y='2' width='6' height='8' rx='2' ry='3'/>"),
            Path("M3 2H5A2 3 0 0 1 7 5V7A2 3 0 0 1 5 10H3A2 3 0 0 1 1 7V5A2 3 0 0 1 3 2z"));
  EXPECT_EQ(Svg("<rect width='6' height='8' rx='2'/>"), Svg("<rect width='6' height='8' rx='2' ry='2'/>"));
  EXPECT_EQ(Svg("<rect width='6' height='8' ry='9' rx='auto'/>"), Svg("<rect width='6' height='8' rx='3' ry='4'/>"));
}

TEST(SvgCurves, SmoothCurvesMirrorTheControlPoint) {
  EXPECT_EQ(Path("M0 0C0 1 1 2 2 2S4 1 4 0"), Path("M0 0C0 1 1 2 2 2C3 2 4 1 4 0"));
  EXPECT_EQ(Path("M0 0Q1 2 2 2t2-2t2 2"), Path("M0 0Q1 2 2 2Q3 2 4 0Q5 -2 6 2"));
  EXPECT_EQ(Path("M1 1S4 1 4 0"), Path("M1 1C1 1 4 1 4 0"));
  EXPECT_EQ(Path("M0 0Q1 2 2 2S4 1 4 0"), Path("M0 0Q1 2 2 2C2 2 4 1 4 0"));
  EXPECT_EQ(Path("M0 0A1 1 0 0 0 2 0S4 1 4 0"), Path("M0 0A1 1 0 0 0 2 0C2 0 4 1 4 0"));
}

TEST(SvgCurves, PassesOverWhatDrawsNothing) {
  const auto polylines = ParseSvg(
      "<?xml version='1.0'?><!DOCTYPE svg><!-- c --><svg:svg xmlns:svg='http://www.w3.org/2000/svg' width='5mm'>"
      "<svg:defs><circle/></svg:defs><title>t</title><inkscape:page/>text<svg:g><svg:line x2='1'/></svg:g></svg:svg>");
  ASSERT_TRUE(polylines.ok()) << polylines.status();
  EXPECT_THAT(*polylines, ElementsAre(Open({{0, 0}, {1, 0}})));
}

TEST(SvgCurves, RefusalsNameLineAndElement) {
  for (const char* element : {"image", "foreignObject", "circel"}) {
    EXPECT_THAT(SvgError(absl::StrCat("<g>\n<", element, "/></g>")),
                StartsWith(absl::StrCat("line 3: <", element, "> is not one of")));
  }
  EXPECT_THAT(SvgError("<text>a</text>"), HasSubstr("<text> has no outlines; convert text to paths"));
  EXPECT_THAT(SvgError("<path d='M0 0X'/>"), HasSubstr("path command \"X\" is not one of M L H V Z C S Q T A"));
  EXPECT_THAT(SvgError("<path d='L0 0'/>"), HasSubstr("<path> path data has \"L0\" where M"));
  EXPECT_THAT(SvgError("<path d='M0 0C1 2 3'/>"), HasSubstr("path data ends where a finite number"));
  EXPECT_THAT(SvgError("<path d='M0 0L1,,2'/>"), HasSubstr("path data has \",2\" where a finite number"));
  EXPECT_THAT(SvgError("<path d='M0 0L1 1e999'/>"), HasSubstr("\"1e999\""));
  EXPECT_THAT(SvgError("<path d='M0 0 z 1'/>"), HasSubstr("\"1\" where a command"));
  for (const char* transform :
       {"rotate(45,1)", "skewX(1,2)", "rotateX(1)", "scale()", "matrix(1,2)", "scale", "translate(1", "scale(a)"}) {
    EXPECT_THAT(SvgError(absl::StrCat("<g transform='", transform, "'/>")),
                HasSubstr(absl::StrCat("line 2: <g> transform \"", transform)));
  }
  EXPECT_THAT(SvgError("<rect width='1' height='1' ry='-2'/>"), HasSubstr("<rect> has a negative radius"));
  EXPECT_THAT(SvgError("<rect width='-1' height='1'/>"), HasSubstr("<rect> has a negative size"));
  EXPECT_THAT(SvgError("<line x1='50%'/>"), HasSubstr("<line> x1 \"50%\" needs a viewBox"));
  EXPECT_THAT(SvgError("<line x1='2em'/>"), HasSubstr("x1 \"2em\" is not a finite number"));
  EXPECT_THAT(SvgError("<polygon points='1 2 3'/>"), HasSubstr("<polygon> points"));
  EXPECT_THAT(SvgError("<line x2='1e300' transform='scale(1e300)'/>"), HasSubstr("not finite"));
  EXPECT_THAT(SvgError("<line x2='1'>"), HasSubstr("is not XML"));
  std::string deep;
  for (int n = 0; n < 300; ++n) deep += "<g>";
  for (int n = 0; n < 300; ++n) deep += "</g>";
  EXPECT_THAT(SvgError(deep), HasSubstr("the limit is 256"));
}

// Returns the distance of p from the segment a, b.
double Distance(const Vec2d& p, const Vec2d& a, const Vec2d& b) {
  const double x = b[0] - a[0], y = b[1] - a[1], square = x * x + y * y;
  const double t = square == 0 ? 0 : std::clamp(((p[0] - a[0]) * x + (p[1] - a[1]) * y) / square, 0.0, 1.0);
  return std::hypot(p[0] - a[0] - t * x, p[1] - a[1] - t * y);
}

TEST(Flatten, StaysWithinTheToleranceOfEveryCurve) {
  const std::vector<std::string> curves = {"M0 0Q50 100 100 0", "M0 0C0 100 100 100 100 0",
                                           "M0 0C200 100 -100 100 100 0", "M0 0C100 0 0 0 0 0", "M3 4q0 0 0 0"};
  for (const std::string& data : curves) {
    std::vector<Outline> outlines;
    ASSERT_TRUE(ParsePathData(data, outlines).ok());
    const Outline& outline = outlines.at(0);
    const OutlinePiece& piece = outline.pieces.at(0);
    for (const double tolerance : {10.0, 0.1, 1e-4}) {
      const Polyline polyline = Flatten(outline, tolerance);
      EXPECT_EQ(polyline.points.front(), outline.start);
      EXPECT_EQ(polyline.points.back(), piece.end());
      size_t chord = 0;
      for (int n = 0; n <= 5000; ++n) {
        const double t = n / 5000.0, s = 1 - t;
        const auto& [p, q, r] = piece.control;
        Vec2d at;
        for (size_t m = 0; m < 2; ++m) {
          const double a = outline.start[m];
          at[m] = piece.degree == 2 ? s * s * a + 2 * s * t * p[m] + t * t * q[m]
                                    : s * s * s * a + 3 * s * s * t * p[m] + 3 * s * t * t * q[m] + t * t * t * r[m];
        }
        const size_t chords = polyline.points.size() - 1;
        chord = std::min(chords - 1, static_cast<size_t>(t * static_cast<double>(chords)));
        EXPECT_LE(Distance(at, polyline.points[chord], polyline.points[chord + 1]), tolerance * 1.000001) << data;
      }
    }
  }
}

TEST(Flatten, TakesNoMorePointsThanATenfoldToleranceJustifies) {
  std::vector<Outline> outlines;
  ASSERT_TRUE(ParsePathData("M0 0C0 55 45 100 100 100", outlines).ok());
  const size_t coarse = Flatten(outlines[0], 1).points.size(), fine = Flatten(outlines[0], 0.01).points.size();
  EXPECT_LE(fine, 10 * coarse);
  EXPECT_LE(fine, 80u);
}

class CurveFile : public FilesTest {};

TEST_F(CurveFile, TheExtensionDecidesAndErrorsNameTheFile) {
  const auto text = ReadCurveFile(Write("a.TXT", "0,0 1,1\n"));
  ASSERT_TRUE(text.ok()) << text.status();
  EXPECT_FALSE(text->y_down);
  const auto svg = ReadCurveFile(Write("a.svg", "<svg><polyline points='0,0 1,1'/></svg>"));
  ASSERT_TRUE(svg.ok()) << svg.status();
  EXPECT_TRUE(svg->y_down);
  EXPECT_EQ(svg->polylines, text->polylines);
  const auto says = [](const std::string& path) { return std::string{ReadCurveFile(path).status().message()}; };
  EXPECT_THAT(says(Write("b.pdf", "x")), HasSubstr("b.pdf: drawing format \".pdf\""));
  EXPECT_THAT(says(Write("b.txt", "x")), HasSubstr("b.txt: line 1"));
  EXPECT_THAT(says(Write("c.svg", "<svg/>")), HasSubstr("c.svg: the drawing has no curve"));
  EXPECT_THAT(says(Path("missing.svg")), HasSubstr("missing.svg: no such file"));
}

TEST(PixelOutput, CsvHoldsCoordinatesAndPositionsWithSeventeenDigits) {
  Pixelization pixelization;
  pixelization.grid = {{{0.1, 0}, {0.05, 0.2}}, {1, -2}, 0.1414};
  pixelization.pixels = {{-3, 7}, {0, 0}};
  EXPECT_EQ(*EncodePixels("a.csv", {}, pixelization), "i,j,x,y\n-3,7,1.05,-0.59999999999999987\n0,0,1,-2\n");
  EXPECT_THAT(std::string(EncodePixels("a.bmp", {}, pixelization).status().message()), HasSubstr(".csv .png"));
}

TEST(PixelOutput, PngIsAPictureOfAnyCurveOnAnyLattice) {
  const Drawing drawing{{Open({{0, 0}}), Closed({{0, 0}, {5, 3}, {1e-3, 3}})}, false};
  Pixelization pixelization;
  for (const PlaneBasis& basis :
       {PlaneBasis{}, PlaneBasis{{1, 0}, {7.5, 0.9}}, PlaneBasis{{1e-6, 0}, {0, 1e-6}}, PlaneBasis{{40, 0}, {0, 40}}}) {
    pixelization.grid = {basis, {0, 0}, std::sqrt(std::abs(basis.a[0] * basis.b[1]))};
    for (const auto& pixels : {std::vector<Vec2i>{}, {{0, 0}, {3, 2}}}) {
      pixelization.pixels = pixels;
      const auto png = EncodePixels("a.png", drawing, pixelization);
      ASSERT_TRUE(png.ok()) << png.status();
      EXPECT_THAT(*png, StartsWith("\x89PNG\r\n"));
    }
  }
}

}  // namespace
}  // namespace latvox::client
