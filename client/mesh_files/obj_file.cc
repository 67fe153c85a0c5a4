#include "client/mesh_files/obj_file.h"

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/number_text.h"
#include "client/mesh_files/polygon.h"

// No assimp: its decimal parser misses the nearest number for about one number in a hundred. It gives each face corner
// its own vertex. Its errors name neither line nor index. Exact voxels of the most common text format should not depend
// on that.
namespace latvox::client {
namespace {

template <class... Parts>
absl::Status LineError(size_t line, const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat("line ", line, ": ", parts...));
}

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\r'; }

// Takes the next word off the front of `rest`. Returns "" at the end.
absl::string_view NextWord(absl::string_view& rest) {
  size_t begin = 0;
  while (begin < rest.size() && IsSpace(rest[begin])) ++begin;
  size_t end = begin;
  while (end < rest.size() && !IsSpace(rest[end])) ++end;
  const absl::string_view word = rest.substr(begin, end - begin);
  rest.remove_prefix(end);
  return word;
}

// Reads the statements of the text. A line that ends in a backslash continues on the next one.
class Statements {
 public:
  explicit Statements(absl::string_view text) : rest_(text) {}

  // Returns false at the end.
  bool Next(absl::string_view& statement) {
    if (rest_.empty()) return false;
    line_ = next_line_;
    statement = ReadLine();
    if (!IsContinued(statement)) return true;
    joined_.clear();
    while (IsContinued(statement)) {
      statement.remove_suffix(1);
      absl::StrAppend(&joined_, statement, " ");
      statement = ReadLine();
    }
    absl::StrAppend(&joined_, statement);
    statement = joined_;
    return true;
  }

  // Returns the first line of the statement, counted from 1.
  size_t line() const { return line_; }

 private:
  static bool IsContinued(absl::string_view line) { return !line.empty() && line.back() == '\\'; }

  absl::string_view ReadLine() {
    ++next_line_;
    const size_t end = rest_.find('\n');
    absl::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end == absl::string_view::npos ? rest_.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }

  absl::string_view rest_;
  std::string joined_;
  size_t line_ = 1, next_line_ = 1;
};

// Reads the three numbers from 0 to 1 that many programs write after a position. Anything else is not a color.
std::optional<Color> ReadColor(absl::string_view rest) {
  Color color;
  for (uint8_t& part : color) {
    double x = 0;
    if (!ParseDouble(NextWord(rest), x) || !(x >= 0 && x <= 1)) return std::nullopt;
    part = static_cast<uint8_t>(std::nearbyint(x * 255));
  }
  return color;
}

absl::Status ReadPositions(absl::string_view text, Mesh& mesh) {
  std::vector<Vec3d>& positions = mesh.positions;
  Statements statements(text);
  for (absl::string_view rest; statements.Next(rest);) {
    if (NextWord(rest) != "v") continue;
    Vec3d position;
    for (double& coordinate : position) {
      const absl::string_view word = NextWord(rest);
      if (!ParseDouble(word, coordinate)) {
        return LineError(statements.line(), "coordinate \"", word, "\" of vertex ", positions.size() + 1,
                         " is not a number");
      }
      if (!std::isfinite(coordinate)) {
        return LineError(statements.line(), "vertex ", positions.size() + 1, " is not finite (", word, ")");
      }
    }
    positions.push_back(position);
    if (const auto color = ReadColor(rest)) mesh.colors.push_back(*color);
  }
  return absl::OkStatus();
}

std::string Name(absl::string_view rest) { return std::string(absl::StripAsciiWhitespace(rest)); }

// Reads "7", "7/1", "7//3" or "-2": the index of a position, counted from 1, or backwards from the last vertex before
// this line.
absl::StatusOr<uint32_t> ParseCorner(absl::string_view word, size_t line, size_t vertices_before, size_t vertices) {
  const absl::string_view number = word.substr(0, word.find('/'));
  int64_t index = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), index);
  if (error == std::errc::result_out_of_range) {
    return LineError(line, "vertex index ", number, " of a face exceeds the file's ", vertices, " vertices");
  }
  if (error != std::errc() || end != number.data() + number.size()) {
    return LineError(line, "vertex index \"", word, "\" of a face is not a number");
  }
  const int64_t from_zero = index > 0 ? index - 1 : static_cast<int64_t>(vertices_before) + index;
  if (index == 0 || from_zero < 0 || from_zero >= static_cast<int64_t>(vertices)) {
    return LineError(line, "vertex index ", index, " of a face is not within the file's ", vertices, " vertices");
  }
  return static_cast<uint32_t>(from_zero);
}

absl::Status ReadFaces(absl::string_view text, Mesh& mesh) {
  Statements statements(text);
  size_t vertices_before = 0;
  std::vector<uint32_t> polygon;
  absl::flat_hash_map<std::string, uint32_t> materials;
  Stretch stretch;
  for (absl::string_view rest; statements.Next(rest);) {
    const absl::string_view keyword = NextWord(rest);
    if (keyword == "v") ++vertices_before;
    if (keyword == "l" || keyword == "p") ++mesh.skipped;
    if (keyword == "o") {
      stretch.part = NextPart(mesh);
      SetName(stretch.part, Name(rest), mesh.part_names);
    }
    if (keyword == "usemtl") {
      stretch.material = materials.try_emplace(Name(rest), static_cast<uint32_t>(materials.size())).first->second;
      SetName(*stretch.material, Name(rest), mesh.material_names);
    }
    if (keyword == "o" || keyword == "usemtl") BeginStretch(stretch.part, stretch.material, mesh);
    if (keyword != "f") continue;
    polygon.clear();
    for (absl::string_view word = NextWord(rest); !word.empty() && word[0] != '#'; word = NextWord(rest)) {
      const auto corner = ParseCorner(word, statements.line(), vertices_before, mesh.positions.size());
      if (!corner.ok()) return corner.status();
      polygon.push_back(*corner);
    }
    if (polygon.size() < 3)
      return LineError(statements.line(), "a face has ", polygon.size(), " corners, not 3 or more");
    Triangulate(polygon, mesh.positions, mesh.triangles);
  }
  mesh.materials = static_cast<uint32_t>(materials.size());
  return absl::OkStatus();
}

}  // namespace

// Two passes: faces may refer to later vertices, and cutting a polygon needs the positions of its corners.
absl::StatusOr<Mesh> ParseObj(absl::string_view text) {
  Mesh mesh;
  if (auto status = ReadPositions(text, mesh); !status.ok()) return status;
  if (auto status = ReadFaces(text, mesh); !status.ok()) return status;
  return mesh;
}

}  // namespace latvox::client
