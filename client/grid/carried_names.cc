#include "latvox/grid/carried_names.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "client/grid/names_keys.h"

namespace latvox::client {
namespace {

std::vector<std::string> ParseNames(const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  const auto is_text = [](const auto& name) { return name.is_string(); };
  if (!json.is_array() || !std::all_of(json.begin(), json.end(), is_text)) return {};
  return json.get<std::vector<std::string>>();
}

}  // namespace

CarriedNames ReadCarriedNames(const GridFileInfo& info) {
  CarriedNames names;
  for (const auto& [key, text] : info.metadata) {
    if (key == kNamesKeys[0].second) names.parts = ParseNames(text);
    if (key == kNamesKeys[1].second) names.materials = ParseNames(text);
  }
  return names;
}

}  // namespace latvox::client
