#include "client/grid/names_metadata.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "client/grid/names_keys.h"

namespace latvox::client {

Metadata NamesMetadata(const CarriedNames& names, Field attribute) {
  for (const auto& [named, key] : kNamesKeys) {
    std::vector<std::string> kept = names.Of(attribute);
    if (named != attribute || kept.empty()) continue;
    kept.resize(std::min(kept.size(), kMostNames));
    const nlohmann::json json = kept;
    // Names of files need not be UTF-8.
    return {{key, ToMetadata(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace))}};
  }
  return {};
}

}  // namespace latvox::client
