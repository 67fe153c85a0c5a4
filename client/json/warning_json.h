// Warnings as JSON.
#ifndef LATVOX_CLIENT_JSON_WARNING_JSON_H_
#define LATVOX_CLIENT_JSON_WARNING_JSON_H_

#include <vector>

#include "client/json/json.h"
#include "latvox/warning.h"

namespace latvox::client {

// Returns a list of {"code", "message", "element"}.
inline Json WarningsJson(const std::vector<Warning>& warnings) {
  Json list = Json::array();
  for (const auto& [code, message, element] : warnings) {
    list.push_back({{"code", code}, {"message", message}, {"element", element}});
  }
  return list;
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_JSON_WARNING_JSON_H_
