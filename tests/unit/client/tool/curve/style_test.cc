// The styles of drawings: attributes, the attribute `style` and sheets mean the same, in the order of CSS.
#include <gmock/gmock.h>

#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/tool/curve/svg_curves.h"

namespace latvox::client {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<Polyline> Svg(absl::string_view elements) {
  auto polylines = ParseSvg(absl::StrCat("<svg viewBox='0 0 20 40'>\n", elements, "\n</svg>"));
  EXPECT_TRUE(polylines.ok()) << polylines.status() << "\n" << elements;
  return polylines.value_or(std::vector<Polyline>{});
}

std::string Error(absl::string_view elements) {
  const auto status = ParseSvg(absl::StrCat("<svg>\n", elements, "\n</svg>")).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << elements;
  return std::string{status.message()};
}

// Returns the ends, in x, of the lines that are left: line n ends at n.
std::vector<double> Ends(absl::string_view elements) {
  std::vector<double> ends;
  for (const Polyline& line : Svg(elements)) ends.push_back(line.points[1][0]);
  return ends;
}

TEST(SvgStyle, GeometryPropertiesInStyleAreThoseOfAttributes) {
  EXPECT_EQ(Svg("<rect style='x: 1px; y:2PX; width:3px;height:4px; rx:1px; ry:auto' width='9'/>"),
            Svg("<rect x='1' y='2' width='3' height='4' rx='1'/>"));
  EXPECT_EQ(Svg("<circle style='cx:1px;cy:10%;r:2px'/>"), Svg("<circle cx='1' cy='4' r='2'/>"));
  EXPECT_EQ(Svg("<ellipse style='rx:1mm;ry:2mm'/>"), Svg("<ellipse rx='1mm' ry='2mm'/>"));
}

TEST(SvgStyle, PathDataInStyle) {
  EXPECT_EQ(Svg("<path style='d: path(\"M0 0L1 2\")' d='M5 5H6'/>"), Svg("<path d='M0 0L1 2'/>"));
  EXPECT_THAT(Svg("<path d='M0 0H1' style='d:none'/>"), IsEmpty());
  EXPECT_THAT(Error("<path style='d: url(a)'/>"), HasSubstr("has the style \"d: url(a)\", which is not none or path"));
}

TEST(SvgStyle, SizesOfDrawingsInStyle) {
  EXPECT_EQ(Svg("<svg style='width:8px;height:8px' viewBox='0 0 4 2'><path d='M0 0L4 2'/></svg>"),
            Svg("<svg width='8' height='8' viewBox='0 0 4 2'><path d='M0 0L4 2'/></svg>"));
  EXPECT_EQ(Svg("<svg width='auto' style='height:auto'><line x2='50%'/></svg>"), Svg("<line x2='10'/>"));
  const auto root = ParseSvg("<svg style='width:30px;height:8px'><line x2='50%' y2='50%'/></svg>");
  ASSERT_TRUE(root.ok()) << root.status();
  EXPECT_EQ(root->at(0).points[1], (Vec2d{15, 4}));
}

TEST(SvgStyle, TransformsOfCss) {
  const auto same = [](const std::string& style, const std::string& attribute) {
    const std::string line = "<path d='M1 2L3 4' ";
    const auto a = Svg(line + "style='" + style + "'/>"), b = Svg(line + "transform='" + attribute + "'/>");
    ASSERT_EQ(a.size(), 1U);
    for (size_t n = 0; n < 2; ++n) {
      for (size_t m = 0; m < 2; ++m) EXPECT_NEAR(a[0].points[n][m], b[0].points[n][m], 1e-12) << style;
    }
  };
  same("transform: rotate(45deg)", "rotate(45)");
  same("TRANSFORM:Rotate(.125turn)", "rotate(45)");
  same("transform:rotate(50grad) rotate(0)", "rotate(45)");
  same("transform:rotate(3.14159265358979323846rad)", "rotate(180)");
  same("transform:translate(1in, 10%) scale(2)", "translate(96,4) scale(2)");
  same("transform:translateX(50%)translateY(calc(10% - 1px))", "translate(10,3)");
  same("transform:scaleX(2) scaleY(3)", "scale(2,3)");
  same("transform:skew(10deg, 0)", "skewX(10)");
  same("transform:skewX(10deg) skewY(20deg)", "skewX(10) skewY(20)");
  same("transform:matrix(1, 2, 3, 4, 5, 6)", "matrix(1 2 3 4 5 6)");
  same("transform:none", "");
  same("transform:rotate(90deg);transform-origin:3px 4px", "rotate(90 3 4)");
  same("transform:rotate(90deg);transform-origin: calc( 2 * 4px ) 0", "rotate(90 8 0)");
  same("transform:translate(0 , 0) translateX(calc( (1px + 1px) * 2 ))", "translate(4)");
  same("transform:rotate(90deg);transform-origin:center", "rotate(90 10 20)");
  same("transform:rotate(90deg);transform-origin:bottom right 0", "rotate(90 20 40)");
  same("transform:rotate(90deg);transform-origin:center left", "rotate(90 0 20)");
  same("transform:rotate(90deg);transform-origin:4px top", "rotate(90 4 0)");
  same("transform:rotate(90deg);transform-origin:top;transform-box:view-box", "rotate(90 10 0)");
  same("-webkit-transform:rotate(90deg)", "rotate(90)");
  EXPECT_EQ(Svg("<path d='M1 2L3 4' transform='rotate(90)' transform-origin='3 4'/>"),
            Svg("<path d='M1 2L3 4' transform='rotate(90 3 4)'/>"));
  for (const char* transform :
       {"rotateX(1deg)", "translate3d(1px,0,0)", "translate(1em)", "rotate(1px)", "scale(1px)", "rotate(1deg"}) {
    EXPECT_THAT(Error(absl::StrCat("<g style='transform:", transform, "'/>")),
                HasSubstr(absl::StrCat("line 2: <g> transform \"", transform)));
  }
  EXPECT_THAT(Error("<g transform='translate(50%)'/>"),
              HasSubstr("transform \"translate(50%)\" has the argument \"50%\", which needs a viewBox"));
  EXPECT_THAT(Error("<g transform='turn(1)'/>"),
              HasSubstr("px, in, cm, mm, Q, pt, pc and % of lengths, and deg, grad, rad and turn of angles"));
  EXPECT_THAT(Error("<g style='transform:none;transform-origin:1em'/>"), HasSubstr("transform-origin \"1em\" is not"));
  for (const char* origin : {"top 4px", "4px left", "bottom 0", "50% right 1px"}) {
    EXPECT_THAT(Error(absl::StrCat("<g style='transform:none;transform-origin:", origin, "'/>")),
                HasSubstr(absl::StrCat("transform-origin \"", origin,
                                       "\" has a length or %, so the horizontal place comes first")));
  }
  EXPECT_THAT(Error("<g style='transform:scale(2);transform-box:fill-box'/>"), HasSubstr("transform-box \"fill-box\""));
}

TEST(SvgStyle, LengthsAreComputed) {
  const auto x = [](const std::string& length) { return Svg("<line x2='" + length + "'/>").at(0).points[1][0]; };
  EXPECT_EQ(x("calc(1in - 2 * (3px + 1pc))"), 96 - 2 * 19);
  EXPECT_EQ(x(" calc( 50% + 4px / 2 ) "), 12);
  EXPECT_EQ(x("calc(-1 * calc(2px - -3px))"), -5);
  EXPECT_EQ(x("min(3px, 50%)") + x("max(3px,50%)") + x("clamp(1px, 9px, 4px)"), 3 + 10 + 4);
  EXPECT_EQ(x("calc(2 * 3)"), 6);
  for (const char* wrong :
       {"calc(1px + 2)", "calc(1px+ 2px)", "calc(1px * 1px)", "calc(1 / 1px)", "calc(1px / 0)", "calc(1px, 2px)",
        "calc(1px", "calc()", "sin(1)", "clamp(1px,2px)", "calc(1em)", "1px)", "(5)", "(5px)"}) {
    EXPECT_THAT(Error(absl::StrCat("<line x2='", wrong, "'/>")), HasSubstr(absl::StrCat("<line> x2 \"", wrong)));
  }
  EXPECT_THAT(Error("<line x2='" + std::string(100, '(') + "'/>"), HasSubstr("<line> x2"));
}

TEST(SvgStyle, SheetsSelectByTypeClassAndId) {
  const std::string lines = "<line id='a' class='p q' x2='1'/><line class='q' x2='2'/><g><path d='M0 0H3'/></g>";
  const auto left = [&](const std::string& css) { return Ends("<style>" + css + "</style>" + lines); };
  EXPECT_THAT(left(""), ElementsAre(1, 2, 3));
  EXPECT_THAT(left(".q{display:none}"), ElementsAre(3));
  EXPECT_THAT(left("/* { */ .p { fill : red ; display : NONE }"), ElementsAre(2, 3));
  EXPECT_THAT(left("#a,path{display:none;}"), ElementsAre(2));
  EXPECT_THAT(left("line.q#a{display:none}.r{display:none}Path{display:none}"), ElementsAre(2, 3));
  EXPECT_THAT(left(".p.q{display:none}"), ElementsAre(2, 3));
  EXPECT_THAT(left("*{display:none}"), IsEmpty());
  EXPECT_THAT(left("g{display:none"), ElementsAre(1, 2));
  EXPECT_THAT(Ends(lines + "<defs><style type='text/css'><![CDATA[.q{display:none}]]></style></defs>"), ElementsAre(3));
  EXPECT_THAT(Ends("<style type='text/less'>.q{display:none}</style>" + lines), ElementsAre(1, 2, 3));
  EXPECT_EQ(Svg("<style>.a{transform:translate(1px,2px);r:3px}</style><circle class='a' r='9' transform='scale(2)'/>"),
            Svg("<circle r='3' transform='translate(1,2)'/>"));
}

TEST(SvgStyle, TheCascadeDecides) {
  // Each declaration alone moves the line. The one that wins is that of 7.
  for (const auto& [css, attributes] :
       {std::pair("", "style='transform:translate(7px)' transform='translate(1)'"),
        {".a{transform:translate(7px)}line{transform:translate(1px)}", ""},
        {"#b{transform:translate(7px)}.a.c{transform:translate(1px)}", ""},
        {".a.c{transform:translate(7px)}line.a{transform:translate(1px)}", ""},
        {".c{transform:translate(1px)}.a{transform:translate(7px)}", ""},
        {"#b{transform:translate(1px)}", "style='transform:translate(7px)'"},
        {"line{transform:translate(7px)!important}", "style='transform:scale(2)'"},
        {"#b{transform:scale(2)!important}", "style='transform:translate(7px) ! IMPORTANT'"},
        {"line{transform:translate(1px);transform:translate(7px)}", ""},
        {"*.a{transform:translate(7px)}", "transform='translate(1)'"}}) {
    EXPECT_EQ(Svg(absl::StrCat("<style>", css, "</style><line id='b' class='a c' y2='1' ", attributes, "/>")),
              Svg("<path d='M7 0V1'/>"))
        << css << attributes;
  }
  EXPECT_THAT(Ends("<style>line{display:none}</style><line style='display:initial' x2='1'/>"), ElementsAre(1));
}

TEST(SvgStyle, VisibilityIsInherited) {
  EXPECT_THAT(Ends("<g visibility='hidden'><line x2='1'/><line x2='2' style='visibility:visible'/></g>"
                   "<g style='visibility:collapse'><g visibility='inherit'><line x2='3'/></g></g>"
                   "<line x2='4' visibility='hidden' style='visibility:initial'/>"
                   "<defs><line id='l' x2='5'/></defs><use href='#l' visibility='hidden'/>"),
              ElementsAre(2, 4));
  EXPECT_THAT(Ends("<symbol id='s' style='display:none'><line x2='1'/></symbol><use href='#s'/>"), IsEmpty());
}

TEST(SvgStyle, TheRootMayBeHidden) {
  for (const char* attributes :
       {"style='display:none'", "visibility='hidden'", "style='visibility:collapse'", "id='r'"}) {
    const auto root = ParseSvg(absl::StrCat("<svg ", attributes, "><style>#r{visibility:hidden}</style>",
                                            "<line x2='1'/><line x2='2' visibility='visible'/></svg>"));
    ASSERT_TRUE(root.ok()) << root.status();
    EXPECT_EQ(root->size(), absl::StrContains(attributes, "display") ? 0U : 1U) << attributes;
  }
}

TEST(SvgStyle, PassesOverWhatDoesNotMatter) {
  const std::string css =
      "@charset \"utf-8\"; @namespace svg url(http://www.w3.org/2000/svg);"
      "@font-face { font-family: 'a}'; src: URL( data:font/woff;base64,/*'}) }"
      "@keyframes k { from { transform: rotate(0) } to { transform: rotate(1turn) } }"
      "@media print { g > path { fill: red } }"
      ".a:hover { transform: scale(2) } .b path:first-child { stroke: url(#x); rotate: none }"
      ".a:hover, .a:focus-within { rotate: 45deg; .d { display: none } } .c:active { width: 5 }"
      ".c { translate: none; zoom: 1; animation: k 1s; opacity: 0; --x: { } }"
      ".d { background: url(/*\\)\"{); cursor: url( '/*)' ) }"
      ".e { display: none }";
  EXPECT_THAT(Ends("<style>" + css + "</style><line class='a b c d' x2='1' style='offset:0.5'/><line class='e'/>"),
              ElementsAre(1));
}

TEST(SvgStyle, ManyComparisonsAreRefused) {
  std::string list, lines;
  for (int n = 0; n < 1000; ++n) list += ".a.b,";
  for (int n = 0; n < 4000; ++n) lines += "<g class='a'/>";
  EXPECT_THAT(Error(absl::StrCat("<style>", list, ".b{display:none}</style>", lines)),
              HasSubstr("exceeds the limit of 10000000 selectors and declarations to compare with elements"));
  std::string classes;
  for (int n = 0; n < 100'000; ++n) classes += "a ";
  list.clear();
  for (int n = 0; n < 1000; ++n) list += ".a{r:1px}";
  EXPECT_THAT(Ends(absl::StrCat("<style>", list, "</style><line x2='1' class='", classes, "'/>")), ElementsAre(1));
}

TEST(SvgStyle, RefusalsNameTheRule) {
  const auto refuses = [](const std::string& css, const std::string& says) {
    EXPECT_THAT(Error("<style>" + css + "</style>"),
                AllOf(HasSubstr("line 2: <style> has the style \""), HasSubstr(says)));
  };
  for (const char* selector :
       {"g path", "g > path", "a + b", "a ~ b", "[x]", ":root", "a:not(.b:hover)", "a\\:b", "a::before", "",
        ".a:is(:hover, .b)", ":where(:focus,.b)", ".a\\:hover", "[title=':hover']", "#1", ".5a", "1", ".-1", "-"}) {
    refuses(absl::StrCat(".x, ", selector, " { display: none }"), absl::StrCat("not \"", selector, "\""));
  }
  refuses("{display:none}", "has the style \"\"");
  refuses("@import url(x.css);", "\"@import url(x.css)\", and this rule is not read");
  refuses("@media print { .a { display:none } }", "\".a\", and rules that apply under a condition are not read");
  refuses("@supports (a:b) { @media all { .a { r:1px } } }", "\".a\", and rules that apply under a condition");
  refuses(".a { --x:{}; .b { display:none } }", "\".a\", and nested rules are not read");
  refuses(".a { width: 5 }", "\"width: 5\", and CSS demands a unit");
  refuses(".a { transform: rotate(45) }", "and CSS demands a unit");
  refuses(".a { transform-origin: 4 4 }", "and CSS demands a unit");
  refuses(".a { width: var(--w) }", "and var() is not read");
  for (const char* length : {"5", "calc(2*3)", "calc(0)", "min(3,4)", "max(3, calc(4))"}) {
    refuses(absl::StrCat(".a { x: ", length, " }"), "and CSS demands a unit");
    refuses(absl::StrCat(".a { transform: translate(1px, ", length, ") }"), "and CSS demands a unit");
    refuses(absl::StrCat(".a { transform-origin: 0 ", length, " }"), "and CSS demands a unit");
  }
  for (const char* transform : {"translate(5px 5px)", "matrix(1 2 3 4 5 6)", "scale(2,)", "scale()", "scale(1,,2)"}) {
    refuses(absl::StrCat(".a { transform: ", transform, " }"), "and CSS demands one comma between arguments");
  }
  for (const char* transform : {"scale(2), scale(3)", "scale (2)", "none scale(2)"}) {
    refuses(absl::StrCat(".a { transform: ", transform, " }"), "and CSS demands a name before each parenthesis");
  }
  refuses(".a { transform: rotate(45deg, 3px, 4px) }", "and in CSS, rotate() has one angle");
  refuses(".a { transform-origin: 3px, 4px }", "and CSS has no comma between lengths");
  for (const char* name : {"x", "d", "transform", "transform-origin", "transform-box", "display", "visibility"}) {
    refuses(absl::StrCat(".a { ", name, ": }"), "which has no value");
  }
  refuses(".a { display: foo }", "and this value of display is not read");
  refuses(".a { visibility: none }", "and this value of visibility is not read");
  refuses(".a { display: inherit }", "and the keyword inherit is not read");
  refuses(".a { rotate: 45deg }", "and the property rotate is not read");
  refuses(".a { offset: path(\"M0 0\") }", "and the property offset is not read");
  EXPECT_THAT(Error("<style media='print'>.a{display:none}</style>"), HasSubstr("apply under a condition"));
  EXPECT_THAT(Error("<g style='width:var(--a)'/>"), HasSubstr("line 2: <g> has the style \"width:var(--a)\""));
  std::string deep;
  for (int n = 0; n < 100; ++n) deep += "@media x{";
  refuses(deep, "the limit is 32");
  for (const char* drawing :
       {"<?xml-stylesheet href='a.css'?><svg/>", "<svg><defs><link rel='StyleSheet' href='a.css'/></defs></svg>",
        "<svg><h:link rel='stylesheet' href='a.css'/></svg>"}) {
    EXPECT_THAT(std::string(ParseSvg(drawing).status().message()), HasSubstr("has a style sheet of its own file"));
  }
  EXPECT_THAT(Ends("<h:link rel='license'/><line x2='1'/>"), ElementsAre(1));
}

}  // namespace
}  // namespace latvox::client
