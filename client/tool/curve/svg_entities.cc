#include "client/tool/curve/svg_entities.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

namespace latvox::client {
namespace {

constexpr int kDeepestEntity = 16;                        // of entities in entities
constexpr size_t kMostUses = 1'000'000;                   // also those in entities
constexpr size_t kMostExpandedBytes = size_t{256} << 20;  // of the document, with its entities written out

class Expander {
 public:
  explicit Expander(absl::string_view xml) : xml_(xml), rest_(xml) {}

  absl::StatusOr<std::string> Run() {
    absl::ConsumePrefix(&rest_, "\xEF\xBB\xBF");
    for (SkipSpace(); SkipNote(); SkipSpace()) continue;
    if (!absl::ConsumePrefix(&rest_, "<!DOCTYPE") || !SkipTo("[>") || rest_[0] == '>') return std::string(xml_);
    rest_.remove_prefix(1);
    if (auto status = ReadDeclarations(); !status.ok()) return status;
    if (texts_.empty()) return std::string(xml_);
    out_ = std::string(xml_.substr(0, xml_.size() - rest_.size()));
    if (auto status = Append(rest_, 0); !status.ok()) return status;
    return std::move(out_);
  }

 private:
  template <class... Parts>
  absl::Status Error(const Parts&... parts) const {
    const auto line = 1 + std::count(xml_.begin(), xml_.end() - static_cast<std::ptrdiff_t>(rest_.size()), '\n');
    return absl::InvalidArgumentError(absl::StrCat("line ", line, ": ", parts...));
  }

  // Goes to the first of these characters that is not in quotes. Returns false if there is none.
  bool SkipTo(absl::string_view any) {
    while (!rest_.empty() && !absl::StrContains(any, rest_[0])) {
      const char c = rest_[0];
      rest_.remove_prefix(1);
      if (c == '"' || c == '\'') SkipPast(absl::string_view(&c, 1));
    }
    return !rest_.empty();
  }

  void SkipPast(absl::string_view end) {
    const size_t at = rest_.find(end);
    rest_.remove_prefix(at == absl::string_view::npos ? rest_.size() : at + end.size());
  }

  // Skips a comment or an instruction. Returns false if there is none.
  bool SkipNote() {
    const bool is_comment = absl::StartsWith(rest_, "<!--");
    if (!is_comment && !absl::StartsWith(rest_, "<?")) return false;
    SkipPast(is_comment ? "-->" : "?>");
    return true;
  }

  void SkipSpace() { rest_ = absl::StripLeadingAsciiWhitespace(rest_); }

  // Goes to the end of the declarations between brackets.
  absl::Status ReadDeclarations() {
    for (SkipSpace(); !rest_.empty() && rest_[0] != ']'; SkipSpace()) {
      if (rest_[0] == '%') {
        return Error("a parameter entity, \"", rest_.substr(0, rest_.find(';')), ";\", is not read");
      }
      if (SkipNote()) continue;
      if (absl::ConsumePrefix(&rest_, "<!ENTITY")) ReadEntity();
      SkipTo(">");
      SkipPast(">");
    }
    return absl::OkStatus();
  }

  // The first of several with a name counts.
  void ReadEntity() {
    SkipSpace();
    if (rest_.empty() || rest_[0] == '%') return;
    const absl::string_view name = Word();
    SkipSpace();
    if (name.empty() || rest_.empty()) return;
    const char quote = rest_[0];
    if (quote != '"' && quote != '\'') {
      texts_.try_emplace(name, std::nullopt);
      return;
    }
    const size_t end = rest_.find(quote, 1);
    if (end == absl::string_view::npos) return;
    texts_.try_emplace(name, rest_.substr(1, end - 1));
    rest_.remove_prefix(end + 1);
  }

  absl::string_view Word() {
    const absl::string_view from = rest_;
    const auto end = std::find_if(from.begin(), from.end(), [](char c) {
      return absl::ascii_isspace(static_cast<unsigned char>(c)) || c == '>' || c == '"' || c == '\'';
    });
    rest_.remove_prefix(static_cast<size_t>(end - from.begin()));
    return from.substr(0, from.size() - rest_.size());
  }

  // Appends a text with its entities written out. Comments and CDATA have none.
  absl::Status Append(absl::string_view text, int depth) {
    if (depth > kDeepestEntity)
      return Error("entities are nested ", depth, " levels deep; the limit is ", kDeepestEntity);
    while (!text.empty()) {
      const size_t at = std::min(text.find_first_of("&<"), text.size());
      if (depth == 0) rest_ = text.substr(at);  // for errors
      const size_t end = EndOfMark(text.substr(at));
      const auto found = texts_.find(text.substr(at, end).substr(std::min<size_t>(end, 1)));
      if (text.substr(at, 1) != "&" || found == texts_.end()) {
        absl::StrAppend(&out_, text.substr(0, at + end));
        text.remove_prefix(at + end);
      } else {
        absl::StrAppend(&out_, text.substr(0, at));
        text.remove_prefix(at + end + 1);  // and the semicolon
        if (!found->second) return Error("the text of \"&", found->first, ";\" is in another file, which is not read");
        if (++uses_ > kMostUses) return Error("exceeds the limit of ", kMostUses, " uses of entities");
        if (auto status = Append(*found->second, depth + 1); !status.ok()) return status;
      }
      if (out_.size() > kMostExpandedBytes)
        return Error("exceeds the limit of ", kMostExpandedBytes, " bytes, with entities written out");
    }
    return absl::OkStatus();
  }

  // Returns the length of what begins the text: a comment, CDATA, the name of an entity with its &, or one character.
  static size_t EndOfMark(absl::string_view text) {
    for (const auto& [begin, end] : {std::pair("<!--", "-->"), std::pair("<![CDATA[", "]]>")}) {
      if (!absl::StartsWith(text, begin)) continue;
      const size_t at = text.find(end);
      return at == absl::string_view::npos ? text.size() : at;
    }
    if (!absl::StartsWith(text, "&")) return std::min<size_t>(text.size(), 1);
    const size_t end = text.find_first_of(";& <\"'\n", 1);
    return end == absl::string_view::npos || text[end] != ';' ? 1 : end;
  }

  const absl::string_view xml_;
  absl::string_view rest_;
  absl::flat_hash_map<absl::string_view, std::optional<absl::string_view>> texts_;  // nullopt: in another file
  std::string out_;
  size_t uses_ = 0;
};

}  // namespace

absl::StatusOr<std::string> ExpandEntities(absl::string_view xml) { return Expander(xml).Run(); }

}  // namespace latvox::client
