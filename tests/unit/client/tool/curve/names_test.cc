// Prefixes of namespaces, and entities that a drawing declares.
#include <gtest/gtest.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "client/tool/curve/svg_curves.h"
#include "client/tool/curve/svg_entities.h"

namespace latvox::client {
namespace {

// Returns the right ends of the lines of a drawing, which begin at 0.
std::string EndsOf(absl::string_view svg) {
  const auto polylines = ParseSvg(svg);
  if (!polylines.ok()) return std::string(polylines.status().message());
  std::string ends;
  for (const Polyline& line : *polylines) absl::StrAppend(&ends, line.points.back()[0], " ");
  return ends;
}

TEST(SvgNames, PrefixesMayBeAny) {
  // As Python's ElementTree writes a drawing.
  EXPECT_EQ(EndsOf("<ns0:svg xmlns:ns0='http://www.w3.org/2000/svg' xmlns:ns1='http://www.w3.org/1999/xlink'>"
                   "<ns0:line id='a' x2='1'/><ns0:use ns1:href='#a' x='1'/></ns0:svg>"),
            "1 2 ");
  // A prefix holds for the element that declares it, and for those within.
  EXPECT_EQ(EndsOf("<svg xmlns='http://www.w3.org/2000/svg'><s:g xmlns:s='http://www.w3.org/2000/svg'>"
                   "<s:line x2='1'/><s:g xmlns:s='other'><s:line x2='2'/><line x2='3'/></s:g></s:g>"
                   "<s:line x2='4'/><g xmlns:s='http://www.w3.org/2000/svg'><s:line x2='5'/></g></svg>"),
            "1 5 ")
      << "an element of another namespace draws nothing, nor do those within";
}

TEST(SvgNames, ElementsOfOtherNamespacesDrawNothing) {
  EXPECT_EQ(EndsOf("<svg xmlns='http://www.w3.org/2000/svg'><line x2='1'/><g xmlns='other'><line x2='2'/></g>"
                   "<metadata><line x2='3' xmlns='other'/></metadata><line xmlns='' x2='4'/></svg>"),
            "1 4 ");
  EXPECT_EQ(EndsOf("<svg><line x2='1'/></svg>"), "1 ") << "without a namespace, all elements are SVG's";
  EXPECT_EQ(EndsOf("<!-- a -->\n\n<svg xmlns='http://www.w3.org/2000/svg/'><line x2='1'/></svg>"),
            "line 3: <svg> is not svg, the root of a drawing, in the namespace http://www.w3.org/2000/svg or in none");
}

TEST(SvgNames, ErrorsHaveTheLinesOfTheFile) {
  EXPECT_EQ(EndsOf("<svg>\n<rect xmlns='other' style='d:'/></svg>").substr(0, 15), "line 2: <rect> ");
  EXPECT_EQ(EndsOf("<s:svg xmlns:s='http://www.w3.org/2000/svg'>\n<s:circel/></s:svg>").substr(0, 17),
            "line 2: <circel> ");
}

std::string WithEntities(absl::string_view declarations, absl::string_view elements) {
  return absl::StrCat("<?xml version='1.0'?>\n<!-- <!DOCTYPE [ -->\n<!DOCTYPE svg PUBLIC '-//a[>//' \"b\" [\n",
                      declarations, "]>\n", elements);
}

TEST(SvgEntities, AreWrittenOut) {
  // As Illustrator writes a drawing: namespaces and styles.
  EXPECT_EQ(
      EndsOf(WithEntities("<!ENTITY ns_svg 'http://www.w3.org/2000/svg'>\n<!-- ' --><!ELEMENT a ANY><?b '?>"
                          "<!ENTITY st0 \"display:none;\"><!ENTITY st1 'display:inline'>",
                          "<svg xmlns='&ns_svg;'><line x2='1' style='&st0;'/><line x2='2' style='&st1;'/></svg>")),
      "2 ");
  EXPECT_EQ(EndsOf(WithEntities("<!ENTITY n '4'><!ENTITY n '5'><!ENTITY lines \"<line x2='&n;2'/><line x2='3&n;'/>\">",
                                "<svg><!-- &lines; -->&lines;<style><![CDATA[ /* &lines; */ ]]></style></svg>")),
            "42 34 ");
}

TEST(SvgEntities, AreTextsWithinValues) {
  EXPECT_EQ(EndsOf(WithEntities("<!ENTITY font 'font-family:\"A<>&#34;'><!ENTITY both \"&font;;x:'\">",
                                "<svg><line x2='1' style='&font;'/><line x2='2' style=\"&both;\"/></svg>")),
            "1 2 ");
}

TEST(SvgEntities, HaveTheirNumbersOfCharactersReplacedOnce) {
  EXPECT_EQ(EndsOf(WithEntities("<!ENTITY amp '&#38;#38;'><!ENTITY r \"&#60;line x2='&#x31;'/>\">",
                                "<svg>&r;<line id='a&amp;b' x2='2'/><use href='#a&#38;b'/></svg>")),
            "1 2 2 ");
}

TEST(SvgEntities, LeaveTheLinesOfTheFile) {
  EXPECT_EQ(EndsOf(WithEntities("<!ENTITY lines '\n<line/>\n\n'>\n",
                                "<svg>&lines;&lines;\n<rect width='z' height='1'/></svg>"))
                .substr(0, 25),
            "line 10: <rect> width \"z\"");
}

TEST(SvgEntities, LeaveEverythingElse) {
  for (const std::string& text :
       {std::string("<svg>&lt;&b;&</svg>"), std::string("<!DOCTYPE svg><svg>&a;</svg>"), std::string("<!DOCTYPE svg ["),
        std::string("<!DOCTYPE svg [<!ENTITY a 'b'"), std::string("<!DOCTYPE svg [<!ENTITY"), std::string(),
        WithEntities("<!ENTITY a 'b'>", "<svg>&lt;&b; &#97; &a &a<?a &a; ?><![CDATA[\"&a;]]></svg>&"),
        WithEntities("<!ENTITY a", "")}) {
    const auto expanded = ExpandEntities(text);
    ASSERT_TRUE(expanded.ok()) << expanded.status();
    EXPECT_EQ(*expanded, text);
  }
}

TEST(SvgEntities, RefusalsNameLineAndEntity) {
  const auto error = [](absl::string_view declarations, absl::string_view elements) {
    return EndsOf(WithEntities(declarations, elements));
  };
  EXPECT_EQ(error("<!ENTITY a SYSTEM 'a.svg'>", "<svg>\n&a;</svg>"),
            "line 6: the text of \"&a;\" is in another file, which is not read");
  EXPECT_EQ(error("<!ENTITY a SYSTEM 'a.svg'>", "<svg><line x2='1'/></svg>"), "1 ");
  EXPECT_EQ(error("<!ENTITY % p 'b'>\n%p;", "<svg/>"), "line 5: a parameter entity, \"%p;\", is not read");
  EXPECT_EQ(EndsOf("<!DOCTYPE svg [ % ]><svg/>"), "line 1: a parameter entity, \"%;\", is not read");
  EXPECT_EQ(error("<!ENTITY a '&a;'>", "<svg>&a;</svg>"),
            "line 5: entities are nested 17 levels deep; the limit is 16");
}

// A few hundred bytes would take hours, and some megabytes would become terabytes.
TEST(SvgEntities, HaveALimitOfUsesAndOfBytes) {
  const auto error = [](size_t bytes) {
    std::string declarations = absl::StrCat("<!ENTITY e0 '", std::string(bytes, 'a'), "'>");
    for (int n = 1; n < 15; ++n) {
      absl::StrAppend(&declarations, "<!ENTITY e", n, " '");
      for (int k = 0; k < 40; ++k) absl::StrAppend(&declarations, "&e", n - 1, ";");
      absl::StrAppend(&declarations, "'>");
    }
    return EndsOf(WithEntities(declarations, "<svg>&e14;</svg>"));
  };
  EXPECT_EQ(error(0), "line 5: exceeds the limit of 1000000 uses of entities");
  EXPECT_EQ(error(size_t{1} << 20), "line 5: exceeds the limit of 67108864 bytes, with entities written out");
}

}  // namespace
}  // namespace latvox::client
