#include "client/mesh_files/off_header.h"

#include <algorithm>
#include <optional>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/strip.h"
#include "client/mesh_files/obj_statements.h"

namespace latvox::client {
namespace {

// The letters before OFF. Geomview orders them ST, C, N, 4, n; MeshLab writes NCSTOFF.
struct OffKeyword {
  bool texture = false, colors = false, normals = false, homogeneous = false, dimension = false;
};

bool ConsumeIgnoringCase(absl::string_view& text, absl::string_view prefix) {
  if (!absl::StartsWithIgnoreCase(text, prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

// Takes the keyword off the front of a word, if it is one. "OFF490" leaves "490", as some files have no space there.
std::optional<OffKeyword> ConsumeKeyword(absl::string_view& word) {
  OffKeyword keyword;
  absl::string_view rest = word;
  while (!ConsumeIgnoringCase(rest, "OFF")) {
    bool* const letter = ConsumeIgnoringCase(rest, "ST")   ? &keyword.texture
                         : ConsumeIgnoringCase(rest, "C")  ? &keyword.colors
                         : absl::ConsumePrefix(&rest, "N") ? &keyword.normals
                         : absl::ConsumePrefix(&rest, "4") ? &keyword.homogeneous
                         : absl::ConsumePrefix(&rest, "n") ? &keyword.dimension
                                                           : nullptr;
    if (letter == nullptr || *letter) return std::nullopt;
    *letter = true;
  }
  if (!rest.empty() && !absl::ascii_isdigit(static_cast<unsigned char>(rest[0]))) return std::nullopt;
  word = rest;
  return keyword;
}

bool IsBinaryWord(absl::string_view word) { return absl::EqualsIgnoreCase(word, "BINARY"); }

// Reads the numbers of vertices and faces. The number of edges, which follows, may be missing or wrong.
absl::Status ReadOffCounts(const std::vector<absl::string_view>& words, size_t line, OffHeader& header) {
  if (words.size() >= 2 && words.size() <= 3 && absl::SimpleAtoi(words[0], &header.vertices) &&
      absl::SimpleAtoi(words[1], &header.faces)) {
    return absl::OkStatus();
  }
  return LineError(line, "\"", words[0].substr(0, 20),
                   "\" does not begin a line of the numbers of vertices, faces and edges");
}

absl::Status ApplyKeyword(const OffKeyword& keyword, size_t line, OffHeader& header) {
  if (keyword.homogeneous || keyword.dimension) {
    return LineError(line,
                     keyword.dimension ? "nOFF has vertices of any dimension" : "4OFF has vertices of four numbers",
                     "; latvox reads OFF, COFF, NOFF, STOFF and their combinations");
  }
  header.has_texture = keyword.texture;
  header.has_colors = keyword.colors;
  header.has_normals = keyword.normals;
  return absl::OkStatus();
}

}  // namespace

bool OffLines::Next(std::vector<absl::string_view>& words) {
  words.clear();
  for (absl::string_view line; words.empty() && lines_.Next(line);) {
    line = line.substr(0, line.find('#'));
    for (absl::string_view word = TakeWord(line); !word.empty(); word = TakeWord(line)) words.push_back(word);
  }
  return !words.empty();
}

bool IsOff(absl::string_view bytes) {
  constexpr size_t kMost = size_t{1} << 16;  // the keyword may follow comments
  OffLines lines(bytes.substr(0, kMost));
  std::vector<absl::string_view> words;
  if (!lines.Next(words) || !ConsumeKeyword(words[0])) return false;
  const absl::string_view next = !words[0].empty() ? words[0] : words.size() > 1 ? words[1] : "0";
  return absl::ascii_isdigit(static_cast<unsigned char>(next[0])) || IsBinaryWord(next);
}

absl::StatusOr<OffHeader> ReadOffHeader(OffLines& lines) {
  OffHeader header;
  std::vector<absl::string_view> words;
  if (!lines.Next(words)) return absl::InvalidArgumentError("not an OFF file: it has no words");
  const absl::string_view first = words[0];
  if (const auto keyword = ConsumeKeyword(words[0])) {
    if (auto status = ApplyKeyword(*keyword, lines.number(), header); !status.ok()) return status;
    if (words[0].empty()) words.erase(words.begin());
    header.is_binary = !words.empty() && IsBinaryWord(words[0]);
    if (header.is_binary) return header;
    if (words.empty() && !lines.Next(words)) return absl::InvalidArgumentError("ends after the keyword OFF");
  } else if (!absl::ascii_isdigit(static_cast<unsigned char>(first[0]))) {
    return absl::InvalidArgumentError(
        absl::StrCat("not an OFF file: it begins with \"", first.substr(0, 20), "\", not with OFF or its counts"));
  }
  if (auto status = ReadOffCounts(words, lines.number(), header); !status.ok()) return status;
  return header;
}

}  // namespace latvox::client
