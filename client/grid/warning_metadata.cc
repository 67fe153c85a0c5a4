#include "client/grid/warning_metadata.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace latvox::client {
namespace {

using Json = nlohmann::ordered_json;

// Names of files in messages may not be UTF-8.
std::string TextOf(const Json& list) { return list.dump(-1, ' ', false, Json::error_handler_t::replace); }

}  // namespace

Metadata WarningMetadata(const std::vector<Warning>& warnings) {
  if (warnings.empty()) return {};
  Json list = Json::array();
  for (const auto& [code, message, element] : warnings) {
    list.push_back({{"code", code}, {"message", message}, {"element", element}});
  }
  return {{kWarningsName, ToMetadata(TextOf(list))}};
}

std::string JoinedWarnings(const std::vector<std::string>& texts) {
  Json joined = Json::array();
  for (const std::string& text : texts) {
    const Json list = Json::parse(text, nullptr, /*allow_exceptions=*/false);
    if (!list.is_array()) continue;
    for (const Json& warning : list) {
      const Json code = warning.is_object() ? warning.value("code", Json()) : Json();
      if (code == "EMPTY_RESULT" || code == "EMPTY_SHARD") continue;
      if (std::find(joined.begin(), joined.end(), warning) == joined.end()) joined.push_back(warning);
    }
  }
  return joined.empty() ? "" : TextOf(joined);
}

}  // namespace latvox::client
