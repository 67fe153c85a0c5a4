// Binary PLY files whose arrays are read at once give the same as files whose numbers are read one by one.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "client/mesh_files/ply_file.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::HasSubstr;

struct Content {
  std::vector<std::array<float, 3>> vertices;
  std::vector<std::vector<int64_t>> faces;
};

// How a file has its numbers. Big-endian ones are read one by one.
struct Layout {
  const char *coordinate, *index;
  bool big_endian, has_normals;
};

class Writer {
 public:
  explicit Writer(const Layout& layout) : layout_(layout) {}

  std::string Write(const Content& content) {
    bytes_ = std::string("ply\nformat binary_") + (layout_.big_endian ? "big" : "little") +
             "_endian 1.0\nelement vertex " + std::to_string(content.vertices.size());
    if (layout_.has_normals) bytes_ += "\nproperty uchar level";
    for (const char* name : {"x", "y", "z"}) bytes_ += std::string("\nproperty ") + layout_.coordinate + " " + name;
    if (layout_.has_normals) bytes_ += "\nproperty double nx\nproperty short flag";
    bytes_ += "\nelement face " + std::to_string(content.faces.size()) + "\nproperty list uchar " + layout_.index +
              " vertex_indices\nend_header\n";
    for (const auto& vertex : content.vertices) WriteVertex(vertex);
    for (const auto& face : content.faces) {
      Append(static_cast<uint8_t>(face.size()));
      for (const int64_t index : face) {
        layout_.index == std::string("int") ? Append(static_cast<int32_t>(index))
                                            : Append(static_cast<uint32_t>(index));
      }
    }
    return bytes_;
  }

 private:
  void WriteVertex(const std::array<float, 3>& vertex) {
    if (layout_.has_normals) Append(uint8_t{9});
    for (const float number : vertex) {
      layout_.coordinate == std::string("double") ? Append(static_cast<double>(number)) : Append(number);
    }
    if (!layout_.has_normals) return;
    Append(0.5);
    Append(int16_t{-3});
  }

  template <class T>
  void Append(T value) {
    std::string bytes = Bytes(value);
    if (layout_.big_endian) std::reverse(bytes.begin(), bytes.end());
    bytes_ += bytes;
  }

  const Layout layout_;
  std::string bytes_;
};

void ExpectSame(const std::string& file, const std::string& other, const ParseOptions& options) {
  const auto mesh = ParsePly(file, options), expected = ParsePly(other, options);
  ASSERT_EQ(mesh.status(), expected.status());
  if (!mesh.ok()) return;
  EXPECT_EQ(mesh->positions, expected->positions);
  EXPECT_EQ(mesh->triangles, expected->triangles);
  EXPECT_EQ(mesh->skipped, expected->skipped);
  ASSERT_EQ(mesh->warnings.size(), expected->warnings.size());
  for (size_t n = 0; n < mesh->warnings.size(); ++n) {
    EXPECT_EQ(mesh->warnings[n].code, expected->warnings[n].code);
    EXPECT_EQ(mesh->warnings[n].message, expected->warnings[n].message);
    EXPECT_EQ(mesh->warnings[n].element, expected->warnings[n].element);
  }
}

// Mostly triangles; also faces of other sizes, indices out of range, and perhaps a vertex that is not finite.
Content Random(std::mt19937& chance, bool has_faults) {
  Content content;
  for (int n = 0; n < 50; ++n) {
    const auto number = [&chance] { return static_cast<float>(chance() % 1000) / 7; };
    content.vertices.push_back({number(), number(), number()});
  }
  if (has_faults && chance() % 2 == 0)
    content.vertices[chance() % 50][chance() % 3] = chance() % 2 == 0 ? NAN : INFINITY;
  for (int n = 0; n < 80; ++n) {
    std::vector<int64_t>& face = content.faces.emplace_back();
    for (unsigned size = chance() % 6 == 0 ? chance() % 6 : 3; size > 0; --size) {
      face.push_back(has_faults && chance() % 60 == 0 ? std::array{-1, 50, 1 << 30}[chance() % 3]
                                                      : static_cast<int64_t>(chance() % 50));
    }
  }
  return content;
}

TEST(PlyArrays, GiveTheSameAsSingleNumbers) {
  std::mt19937 chance(36);
  for (int round = 0; round < 200; ++round) {
    const Content content = Random(chance, round % 2 == 0);
    Layout layout{chance() % 2 == 0 ? "float" : "double", chance() % 2 == 0 ? "int" : "uint", false, chance() % 2 == 0};
    const std::string file = Writer(layout).Write(content);
    layout.big_endian = true;
    const std::string other = Writer(layout).Write(content);
    for (const bool skip : {false, true}) {
      ExpectSame(file, other, {.skip_bad = skip});
      ExpectSame(file + "more", other + "more", {.skip_bad = skip});
    }
  }
}

TEST(PlyArrays, EndWhereTheFileEnds) {
  std::mt19937 chance(37);
  const Content content = Random(chance, false);
  Layout layout{"float", "int", false, false};
  const std::string file = Writer(layout).Write(content);
  layout.big_endian = true;
  std::string other = Writer(layout).Write(content);
  for (size_t less = 1; file.size() - less > file.find("end_header"); ++less) {
    ExpectSame(file.substr(0, file.size() - less), other.substr(0, other.size() - less), {});
  }
}

// The number of faces is a promise of the header, not of the file.
TEST(PlyArrays, TakeNoMemoryForWhatIsNotThere) {
  std::string file = Writer({"float", "uint", false, false}).Write({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}});
  for (const char* element : {"element face 1", "element vertex 3"}) {
    std::string more = file;
    more.insert(more.find(element) + std::string(element).size(), "000000000000");
    EXPECT_THAT(std::string(ParsePly(more).status().message()), HasSubstr("ends or is damaged at"));
  }
}

}  // namespace
}  // namespace latvox::client
