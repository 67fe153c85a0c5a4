// The labels of a set as JSON.
#ifndef LATVOX_CLIENT_JSON_LABELS_JSON_H_
#define LATVOX_CLIENT_JSON_LABELS_JSON_H_

#include "client/json/json.h"
#include "latvox/sets.h"

namespace latvox::client {

// `set`: Solid or Enclosed. Adds nothing if it has no labels.
template <class Set>
void AddLabels(const Set& set, Json& json) {
  if (set.labels) json["labels"] = NameOf(*set.labels);
  if (!set.priority.empty()) json["priority"] = set.priority;
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_JSON_LABELS_JSON_H_
