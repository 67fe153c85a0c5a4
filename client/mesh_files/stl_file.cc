#include "client/mesh_files/stl_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/number_text.h"

// No assimp: its decimal parser misses the nearest number, and its errors name no line.
namespace latvox::client {
namespace {

constexpr size_t kHead = 84, kTriangle = 50, kNormal = 12;

uint32_t DeclaredTriangles(absl::string_view bytes) {
  uint32_t triangles;
  std::memcpy(&triangles, bytes.data() + 80, sizeof(triangles));
  return triangles;
}

// Appends the triangle of the last three positions.
void AppendTriangle(Mesh& mesh) {
  const auto end = static_cast<uint32_t>(mesh.positions.size());
  mesh.triangles.push_back({end - 3, end - 2, end - 1});
}

absl::StatusOr<Mesh> ParseBinary(absl::string_view bytes) {
  if (bytes.size() < kHead)
    return Bad("is not an STL file: neither text with \"solid\" and \"facet\", nor 84 bytes long");
  const uint32_t triangles = DeclaredTriangles(bytes);
  if (triangles > UINT32_MAX / 3) return Bad(triangles, " triangles exceed ", UINT32_MAX / 3);
  Mesh mesh;
  for (uint32_t t = 0; t < triangles; ++t) {
    const absl::string_view rest = bytes.substr(std::min(bytes.size(), kHead + kTriangle * t));
    if (rest.size() < kTriangle) return Bad("ends within triangle ", t, " of ", triangles);
    std::array<std::array<float, 3>, 3> corners;
    std::memcpy(corners.data(), rest.data() + kNormal, sizeof(corners));
    for (const auto& corner : corners) {
      for (const double coordinate : corner) {
        if (!std::isfinite(coordinate)) return Bad("a vertex of triangle ", t, " is not finite (", coordinate, ")");
      }
      mesh.positions.push_back({corner[0], corner[1], corner[2]});
    }
    AppendTriangle(mesh);
  }
  return mesh;
}

// Reads words separated by white space, and counts lines.
class Words {
 public:
  explicit Words(absl::string_view text) : rest_(text) {}

  // Returns the next word, or "" at the end.
  absl::string_view Next() {
    size_t begin = 0;
    for (; begin < rest_.size() && IsSpace(rest_[begin]); ++begin) line_ += rest_[begin] == '\n';
    size_t end = begin;
    while (end < rest_.size() && !IsSpace(rest_[end])) ++end;
    const absl::string_view word = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return word;
  }

  // Returns the rest of the line.
  absl::string_view TakeLine() {
    const absl::string_view line = rest_.substr(0, rest_.find('\n'));
    rest_.remove_prefix(line.size());
    return absl::StripAsciiWhitespace(line);
  }

  // Returns the line of the last word, counted from 1.
  template <class... Parts>
  absl::Status Error(const Parts&... parts) const {
    return Bad("line ", line_, ": ", parts...);
  }

 private:
  static bool IsSpace(char c) { return absl::ascii_isspace(static_cast<unsigned char>(c)); }

  absl::string_view rest_;
  size_t line_ = 1;
};

absl::Status ReadVertex(Words& words, Mesh& mesh) {
  Vec3d& position = mesh.positions.emplace_back();
  for (double& coordinate : position) {
    const absl::string_view word = words.Next();
    if (!ParseDouble(word, coordinate) || !std::isfinite(coordinate)) {
      return words.Error("coordinate \"", word, "\" of a vertex is not a finite number");
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<Mesh> ParseText(absl::string_view text) {
  Words words(text);
  Mesh mesh;
  bool open = false;
  for (absl::string_view word = words.Next(); !word.empty(); word = words.Next()) {
    const std::string statement = absl::AsciiStrToLower(word);
    if (statement == "solid" || statement == "endsolid") {
      open = statement == "solid";
      const uint32_t part = NextPart(mesh);
      BeginStretch(part, std::nullopt, mesh);
      const absl::string_view name = words.TakeLine();  // any text
      if (open) SetName(part, std::string(name), mesh.part_names);
    } else if (statement == "facet" || statement == "outer") {
      // Skips the normal, which nothing uses, and "loop".
      for (int more = statement == "facet" ? 4 : 1; more > 0; --more) words.Next();
    } else if (statement == "vertex") {
      if (auto status = ReadVertex(words, mesh); !status.ok()) return status;
    } else if (statement == "endloop") {
      const size_t corners = mesh.positions.size() - 3 * mesh.triangles.size();
      if (corners != 3) return words.Error("a facet has ", corners, " vertices, not 3");
      AppendTriangle(mesh);
    } else if (statement != "endfacet") {
      return words.Error("\"", word.substr(0, 20), "\" is not an STL keyword");
    }
  }
  if (mesh.positions.size() != 3 * mesh.triangles.size()) return words.Error("ends within a facet");
  if (open) mesh.warnings.push_back({"NO_END", "ends without endsolid: it may be cut short"});
  return mesh;
}

// Returns whether the bytes are text. The length alone does not tell: binary files may be cut short or have trailing
// bytes. The beginning does not either: headers of binary files often begin with "solid".
bool IsText(absl::string_view bytes) {
  const absl::string_view head = absl::StripLeadingAsciiWhitespace(bytes.substr(0, 1024));
  if (IsBinaryStl(bytes) || !absl::StartsWithIgnoreCase(head, "solid") || absl::StrContains(bytes, '\0')) return false;
  const std::string text = absl::AsciiStrToLower(bytes.substr(0, 1 << 16));
  return absl::StrContains(text, "facet") || absl::StrContains(text, "endsolid");
}

}  // namespace

bool IsBinaryStl(absl::string_view bytes) {
  return bytes.size() >= kHead && bytes.size() == kHead + kTriangle * uint64_t{DeclaredTriangles(bytes)};
}

absl::StatusOr<Mesh> ParseStl(absl::string_view bytes) { return IsText(bytes) ? ParseText(bytes) : ParseBinary(bytes); }

}  // namespace latvox::client
