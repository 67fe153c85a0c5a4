#include "client/grid/names_metadata.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

namespace latvox::client {
namespace {

constexpr std::pair<Field, const char*> kKeys[] = {{Field::kPart, "latvox_part_names"},
                                                   {Field::kMaterial, "latvox_material_names"}};

std::vector<std::string> Parse(const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  const auto is_text = [](const auto& name) { return name.is_string(); };
  if (!json.is_array() || !std::all_of(json.begin(), json.end(), is_text)) return {};
  return json.get<std::vector<std::string>>();
}

}  // namespace

void DescribeNames(const CarriedNames& names, Field attribute, openvdb::GridBase& grid) {
  for (const auto& [named, key] : kKeys) {
    std::vector<std::string> kept = names.Of(attribute);
    if (named != attribute || kept.empty()) continue;
    kept.resize(std::min(kept.size(), kMostNames));
    const nlohmann::json json = kept;
    // Names of files need not be UTF-8.
    grid.insertMeta(key, openvdb::StringMetadata(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)));
  }
}

CarriedNames ReadCarriedNames(const GridFileInfo& info) {
  CarriedNames names;
  for (const auto& [key, text] : info.metadata) {
    if (key == kKeys[0].second) names.parts = Parse(text);
    if (key == kKeys[1].second) names.materials = Parse(text);
  }
  return names;
}

}  // namespace latvox::client
