#include "client/mesh_files/three_mf_part.h"

#include <cstdint>
#include <utility>

#include "client/mesh_files/utf16.h"

namespace latvox::client {
namespace {

// Converts UTF-16, which a byte order mark or the zero beside "<" tells, to UTF-8. Returns other text as it is.
std::string ToUtf8(std::string text) {
  constexpr uint32_t kMark = 0xFEFF, kMirroredMark = 0xFFFE;
  if (text.size() < 2) return text;
  const uint32_t first = uint32_t{static_cast<uint8_t>(text[0])} << 8 | static_cast<uint8_t>(text[1]);
  const bool big = first == kMark || first == '<', little = first == kMirroredMark || first == '<' << 8;
  if (!big && !little) return text;
  const size_t mark = first == kMark || first == kMirroredMark ? 2 : 0;
  return Utf8OfUtf16(absl::string_view(text).substr(mark), big);
}

}  // namespace

absl::StatusOr<std::unique_ptr<ThreeMfPart>> ThreeMfPart::Parse(std::string name, std::string text) {
  auto part = std::make_unique<ThreeMfPart>();
  part->name_ = std::move(name);
  part->text_ = ToUtf8(std::move(text));
  for (size_t at = part->text_.find('\n'); at != std::string::npos; at = part->text_.find('\n', at + 1)) {
    part->line_ends_.push_back(at);
  }
  const auto result = part->document_.load_buffer_inplace(part->text_.data(), part->text_.size(), pugi::parse_default,
                                                          pugi::encoding_utf8);
  if (!result) return part->ErrorAt(result.offset, "is not XML (", result.description(), ")");
  return part;
}

}  // namespace latvox::client
