#include "client/grid/metadata_types.h"

#include <cstdint>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "client/grid/grid_metadata.h"
#include "client/grid/request_metadata.h"
#include "latvox/types.h"

namespace latvox::client {
namespace {

// Returns all metadata that are no texts, so that no second list of them can differ.
Metadata TypedExamples() {
  Metadata metadata = PlaceMetadata({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}, 1});
  MeshNote note;
  note.alpha_cutoff = 0;
  note.facts.emplace();
  metadata.merge(RequestMetadata({}, note));
  Certificate certificate;
  certificate.solid.emplace();
  certificate.walk.emplace();
  certificate.band.emplace();
  for (const Field field : {Field::kDistance, Field::kFraction}) certificate.fields.push_back({field, ""});
  metadata.merge(CertificateMetadata(certificate));
  return metadata;
}

bool Parse(const std::string& text, bool& value) { return absl::SimpleAtob(text, &value); }
bool Parse(const std::string& text, double& value) { return absl::SimpleAtod(text, &value); }
template <class Integer>
bool Parse(const std::string& text, Integer& value) {
  return absl::SimpleAtoi(text, &value);
}

// Returns the text as a value of the type; as a text if it is none.
template <class Value>
MetadataValue Typed(const std::string& text) {
  Value value{};
  return Parse(text, value) ? ToMetadata(value) : ToMetadata(text);
}

MetadataValue Typed(const std::string& type, const std::string& text) {
  if (type == ToMetadata(bool{}).type) return Typed<bool>(text);
  if (type == ToMetadata(double{}).type) return Typed<double>(text);
  if (type == ToMetadata(int32_t{}).type) return Typed<int32_t>(text);
  if (type == ToMetadata(int64_t{}).type) return Typed<int64_t>(text);
  return ToMetadata(text);
}

}  // namespace

Metadata TypedMetadata(const std::vector<std::pair<std::string, std::string>>& texts) {
  static const auto* const examples = new Metadata(TypedExamples());
  Metadata metadata;
  for (const auto& [name, text] : texts) {
    if (!absl::StartsWith(name, "latvox_")) continue;
    const auto example = examples->find(name);
    metadata[name] = example == examples->end() ? ToMetadata(text) : Typed(example->second.type, text);
  }
  return metadata;
}

}  // namespace latvox::client
