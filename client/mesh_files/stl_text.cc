#include "client/mesh_files/stl_text.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/number_text.h"
#include "client/mesh_files/text_lines.h"

namespace latvox::client {
namespace {

// Reads words across lines.
class Words {
 public:
  explicit Words(absl::string_view text) : lines_(text) {}

  // Returns the next word, or "" at the end.
  absl::string_view Next() {
    absl::string_view word = TakeWord(line_);
    while (word.empty() && lines_.Next(line_)) word = TakeWord(line_);
    return word;
  }

  // Returns the rest of the line.
  absl::string_view TakeLine() { return absl::StripAsciiWhitespace(std::exchange(line_, "")); }

  // Makes the last word the next one.
  void PutBack(absl::string_view word) { line_ = {word.data(), word.size() + line_.size()}; }

  // Returns the line of the last word, counted from 1.
  size_t line() const { return lines_.number(); }

  template <class... Parts>
  absl::Status Error(const Parts&... parts) const {
    return Bad("line ", line(), ": ", parts...);
  }

 private:
  TextLines lines_;
  absl::string_view line_;  // the rest of it
};

class StlTextReader {
 public:
  StlTextReader(absl::string_view text, const ParseOptions& options) : words_(text), bad_(options) {}

  absl::StatusOr<Mesh> Read() {
    for (absl::string_view word = words_.Next(); !word.empty(); word = words_.Next()) {
      if (auto status = ReadStatement(word); !status.ok()) return status;
    }
    if (!error_.ok()) return error_;
    if (mesh_.positions.size() != 3 * mesh_.triangles.size()) return words_.Error("ends within a facet");
    if (open_) mesh_.warnings.push_back({"NO_END", "ends without endsolid: it may be cut short"});
    if (trailing_ > 0) {
      mesh_.warnings.push_back({"TRAILING_DATA",
                                absl::StrCat("lines after endsolid are ignored; the first: line ", trailing_),
                                absl::StrCat("line ", trailing_)});
    }
    bad_.Report(mesh_);
    return std::move(mesh_);
  }

 private:
  absl::Status ReadStatement(absl::string_view word) {
    const std::string statement = absl::AsciiStrToLower(word);
    if (statement == "solid" || statement == "endsolid") {
      open_ = statement == "solid";
      const uint32_t part = NextPart(mesh_);
      BeginStretch(part, std::nullopt, mesh_);
      const std::string name(words_.TakeLine());  // any text
      if (open_) SetName(part, name, mesh_.part_names);
    } else if (!open_ && statement != "facet") {
      if (trailing_ == 0) trailing_ = words_.line();
      words_.TakeLine();
    } else if (statement == "facet" || statement == "outer") {
      open_ = true;
      SkipUnused(statement == "facet" ? 4 : 1);
      commented_ = words_.line();
    } else if (statement == "vertex") {
      return ReadVertex();
    } else if (statement == "endloop") {
      commented_ = words_.line();
      return EndLoop();
    } else if (statement == "endfacet") {
      commented_ = words_.line();
    } else {
      if (words_.line() != commented_) return words_.Error("\"", word.substr(0, 20), "\" is not an STL keyword");
      words_.TakeLine();
    }
    return absl::OkStatus();
  }

  // Skips the words of a normal, which nothing uses, or "loop". Some of them may be missing.
  void SkipUnused(int most) {
    for (; most > 0; --most) {
      const absl::string_view word = words_.Next();
      if (!IsKeyword(word)) continue;
      words_.PutBack(word);
      break;
    }
  }

  static bool IsKeyword(absl::string_view word) {
    const std::string lower = absl::AsciiStrToLower(word);
    return lower == "outer" || lower == "vertex" || lower == "endloop" || lower == "endfacet" || lower == "endsolid";
  }

  absl::Status ReadVertex() {
    Vec3d& position = mesh_.positions.emplace_back();
    for (double& coordinate : position) {
      const absl::string_view word = words_.Next();
      if (ParseDouble(word, coordinate) && std::isfinite(coordinate)) continue;
      if (error_.ok()) error_ = words_.Error("coordinate \"", word, "\" of a vertex is not a finite number");
      if (!IsKeyword(word)) continue;
      words_.PutBack(word);
      break;
    }
    return absl::OkStatus();
  }

  absl::Status EndLoop() {
    const size_t whole = 3 * mesh_.triangles.size(), corners = mesh_.positions.size() - whole;
    if (error_.ok() && corners != 3) error_ = words_.Error("a facet has ", corners, " vertices, not 3");
    if (error_.ok()) {
      const auto end = static_cast<uint32_t>(mesh_.positions.size());
      mesh_.triangles.push_back({end - 3, end - 2, end - 1});
      return absl::OkStatus();
    }
    const absl::Status error = std::exchange(error_, absl::OkStatus());
    mesh_.positions.resize(whole);
    return bad_.Add(error, absl::StrCat("line ", words_.line()));
  }

  Words words_;
  BadElements bad_;
  Mesh mesh_;
  absl::Status error_;    // of the current facet
  bool open_ = true;      // within a solid
  size_t commented_ = 0;  // the line of the last statement that unknown words may follow
  size_t trailing_ = 0;   // the first line after the last solid; 0: none
};

}  // namespace

absl::StatusOr<Mesh> ParseStlText(absl::string_view text, const ParseOptions& options) {
  return StlTextReader(text, options).Read();
}

}  // namespace latvox::client
