#include "client/mesh_files/three_mf_part.h"

#include <utility>

namespace latvox::client {

absl::StatusOr<std::unique_ptr<ThreeMfPart>> ThreeMfPart::Parse(std::string name, std::string text) {
  auto part = std::make_unique<ThreeMfPart>();
  part->name_ = std::move(name);
  part->text_ = std::move(text);
  for (size_t at = part->text_.find('\n'); at != std::string::npos; at = part->text_.find('\n', at + 1)) {
    part->line_ends_.push_back(at);
  }
  const auto result = part->document_.load_buffer_inplace(part->text_.data(), part->text_.size(), pugi::parse_default,
                                                          pugi::encoding_utf8);
  if (!result) return part->ErrorAt(result.offset, "is not XML (", result.description(), ")");
  return part;
}

}  // namespace latvox::client
