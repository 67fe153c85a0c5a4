#include "client/grid/metadata_types.h"

#include <cstdint>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "client/grid/grid_metadata.h"
#include "client/grid/request_metadata.h"
#include "latvox/types.h"

namespace latvox::client {
namespace {

// Returns a grid with all metadata that are no texts, so that no second list of them can differ.
openvdb::BoolGrid::Ptr NewTypedGrid() {
  auto grid = openvdb::BoolGrid::create();
  Place({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}, 1}, *grid);
  MeshNote note;
  note.alpha_cutoff = 0;
  note.facts.emplace();
  DescribeRequest({}, note, *grid);
  Certificate certificate;
  certificate.solid.emplace();
  certificate.walk.emplace();
  certificate.band.emplace();
  for (const Field field : {Field::kDistance, Field::kFraction}) certificate.fields.push_back({field, ""});
  Describe(certificate, *grid);
  return grid;
}

bool Parse(const std::string& text, bool& value) { return absl::SimpleAtob(text, &value); }
bool Parse(const std::string& text, double& value) { return absl::SimpleAtod(text, &value); }
template <class Integer>
bool Parse(const std::string& text, Integer& value) {
  return absl::SimpleAtoi(text, &value);
}

// Returns null if the text is no such value.
template <class Value>
openvdb::Metadata::Ptr TypedMetadata(const std::string& text) {
  Value value{};
  if (!Parse(text, value)) return nullptr;
  return std::make_shared<openvdb::TypedMetadata<Value>>(value);
}

openvdb::Metadata::Ptr TypedMetadata(const openvdb::Metadata* example, const std::string& text) {
  const std::string type = example == nullptr ? "" : example->typeName();
  if (type == openvdb::BoolMetadata::staticTypeName()) return TypedMetadata<bool>(text);
  if (type == openvdb::DoubleMetadata::staticTypeName()) return TypedMetadata<double>(text);
  if (type == openvdb::Int32Metadata::staticTypeName()) return TypedMetadata<int32_t>(text);
  if (type == openvdb::Int64Metadata::staticTypeName()) return TypedMetadata<int64_t>(text);
  return nullptr;
}

}  // namespace

void InsertTexts(const std::vector<std::pair<std::string, std::string>>& metadata, openvdb::GridBase& grid) {
  static const openvdb::BoolGrid::ConstPtr examples = NewTypedGrid();
  for (const auto& [name, text] : metadata) {
    if (!absl::StartsWith(name, "latvox_")) continue;
    const openvdb::Metadata::ConstPtr example = (*examples)[name];
    const openvdb::Metadata::Ptr typed = TypedMetadata(example.get(), text);
    if (typed) {
      grid.insertMeta(name, *typed);
    } else {
      grid.insertMeta(name, openvdb::StringMetadata(text));
    }
  }
}

}  // namespace latvox::client
