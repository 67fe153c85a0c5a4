#include "client/tool/curve/svg_entities.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <pugixml.hpp>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

namespace latvox::client {
namespace {

constexpr int kDeepestEntity = 16;  // of entities in entities
constexpr size_t kLongestName = 256;
constexpr size_t kMostUses = 1'000'000;                  // also those in entities
constexpr size_t kMostExpandedBytes = size_t{64} << 20;  // of the document, with its entities written out

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
  using Texts = absl::flat_hash_map<absl::string_view, std::optional<std::string>>;  // nullopt: in another file

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
      if (rest_[0] == '%') return Error("a parameter entity, \"", NameAt(rest_), ";\", is not read");
      if (SkipNote()) continue;
      if (absl::ConsumePrefix(&rest_, "<!ENTITY")) ReadEntity();
      SkipTo(">");
      SkipPast(">");
    }
    return absl::OkStatus();
  }

  // The first of several with a name counts. Readers of XML know five names by themselves.
  void ReadEntity() {
    SkipSpace();
    if (rest_.empty() || rest_[0] == '%') return;
    const absl::string_view name = Word();
    SkipSpace();
    if (name.empty() || rest_.empty()) return;
    for (const char* known : {"lt", "gt", "amp", "quot", "apos"}) {
      if (name == known) return;
    }
    const char quote = rest_[0];
    if (quote != '"' && quote != '\'') {
      texts_.try_emplace(name, std::nullopt);
      return;
    }
    const size_t end = rest_.find(quote, 1);
    if (end == absl::string_view::npos) return;
    texts_.try_emplace(name, WithCharacters(rest_.substr(1, end - 1)));
    rest_.remove_prefix(end + 1);
  }

  // Replaces the numbers of characters, as the declaration of an entity does.
  static std::string WithCharacters(absl::string_view text) {
    std::string out;
    for (size_t at; (at = text.find('&')) != absl::string_view::npos;) {
      absl::StrAppend(&out, text.substr(0, at));
      text.remove_prefix(at);
      const absl::string_view name = NameAt(text);
      uint32_t code = 0;
      const bool is_hex = absl::StartsWith(name, "&#x");
      const bool is_number =
          absl::StartsWith(name, "&#") && text.substr(name.size(), 1) == ";" &&
          (is_hex ? absl::SimpleHexAtoi(name.substr(3), &code) : absl::SimpleAtoi(name.substr(2), &code));
      if (is_number && code > 0 && code <= 0x10FFFF) {
        out += pugi::as_utf8(std::wstring(1, static_cast<wchar_t>(code)));
        text.remove_prefix(name.size() + 1);
      } else {
        out += '&';
        text.remove_prefix(1);
      }
    }
    return absl::StrCat(out, text);
  }

  absl::string_view Word() {
    const absl::string_view from = rest_;
    const auto end = std::find_if(from.begin(), from.end(), [](char c) {
      return absl::ascii_isspace(static_cast<unsigned char>(c)) || c == '>' || c == '"' || c == '\'';
    });
    rest_.remove_prefix(static_cast<size_t>(end - from.begin()));
    return from.substr(0, from.size() - rest_.size());
  }

  // Appends a text with its entities written out. Comments, CDATA and instructions have none.
  absl::Status Append(absl::string_view text, int depth) {
    if (depth > kDeepestEntity) {
      return Error("entities are nested ", depth, " levels deep; the limit is ", kDeepestEntity);
    }
    while (!text.empty()) {
      const size_t plain = static_cast<size_t>(std::find_if(text.begin(), text.end(), IsMark) - text.begin());
      absl::StrAppend(&out_, text.substr(0, plain));
      text.remove_prefix(plain);
      if (depth == 0) rest_ = text;  // for errors
      if (const auto found = FindEntity(text); found != texts_.end()) {
        if (!found->second) return Error("the text of \"&", found->first, ";\" is in another file, which is not read");
        if (++uses_ > kMostUses) return Error("exceeds the limit of ", kMostUses, " uses of entities");
        if (auto status = Append(*found->second, depth + 1); !status.ok()) return status;
        text.remove_prefix(found->first.size() + 2);
      } else if (!text.empty()) {
        const size_t length = quote_ == '\0' ? LengthOfNote(text) : 1;
        for (const char c : text.substr(0, length)) AppendCharacter(c, length == 1, depth);
        text.remove_prefix(length);
      }
      if (out_.size() > kMostExpandedBytes) {
        return Error("exceeds the limit of ", kMostExpandedBytes, " bytes, with entities written out");
      }
    }
    return absl::OkStatus();
  }

  // Quotes of an entity within a value in quotes do not end it. Lines of errors are those of the document, so an entity
  // has no end of a line.
  void AppendCharacter(char c, bool is_markup, int depth) {
    if (c == '\n' && depth > 0) c = ' ';
    if (is_markup && quote_ != '\0' && depth > depth_of_value_) {
      absl::StrAppend(&out_, c == '"' ? "&quot;" : c == '\'' ? "&apos;" : c == '<' ? "&lt;" : std::string(1, c));
      return;
    }
    out_ += c;
    if (!is_markup) return;
    if (quote_ != '\0') {
      if (c == quote_) quote_ = '\0';
    } else if (c == '<' || c == '>') {
      is_in_tag_ = c == '<';
    } else if (is_in_tag_ && (c == '"' || c == '\'')) {
      quote_ = c;
      depth_of_value_ = depth;
    }
  }

  // The characters that change what follows. (string_view::find_first_of makes a table for each call.)
  static bool IsMark(char c) { return c == '&' || c == '<' || c == '>' || c == '"' || c == '\'' || c == '\n'; }

  // Returns what begins with & or % and may be a name, as far as it is one.
  static absl::string_view NameAt(absl::string_view text) {
    const auto ends = [](char c) {
      return c == ';' || c == '%' || IsMark(c) || absl::ascii_isspace(static_cast<unsigned char>(c));
    };
    text = text.substr(0, kLongestName);
    if (text.empty()) return text;
    return text.substr(0, static_cast<size_t>(std::find_if(text.begin() + 1, text.end(), ends) - text.begin()));
  }

  Texts::const_iterator FindEntity(absl::string_view text) const {
    if (!absl::StartsWith(text, "&")) return texts_.end();
    const absl::string_view name = NameAt(text);
    return text.substr(name.size(), 1) == ";" ? texts_.find(name.substr(1)) : texts_.end();
  }

  // Returns the length of the comment, the CDATA or the instruction that begins the text; otherwise 1.
  static size_t LengthOfNote(absl::string_view text) {
    for (const auto& [begin, end] : {std::pair("<!--", "-->"), std::pair("<![CDATA[", "]]>"), std::pair("<?", "?>")}) {
      if (!absl::StartsWith(text, begin)) continue;
      const size_t at = text.find(end);
      return at == absl::string_view::npos ? text.size() : at + absl::string_view(end).size();
    }
    return 1;
  }

  const absl::string_view xml_;
  absl::string_view rest_;
  Texts texts_;
  std::string out_;
  size_t uses_ = 0;
  bool is_in_tag_ = false;
  char quote_ = '\0';       // around the value where out_ ends; \0: it ends outside of values
  int depth_of_value_ = 0;  // of that quote
};

}  // namespace

absl::StatusOr<std::string> ExpandEntities(absl::string_view xml) { return Expander(xml).Run(); }

}  // namespace latvox::client
