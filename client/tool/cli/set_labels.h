// The labels of a set of a request.
#ifndef LATVOX_CLIENT_TOOL_CLI_SET_LABELS_H_
#define LATVOX_CLIENT_TOOL_CLI_SET_LABELS_H_

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "latvox/sets.h"

namespace latvox::client {

struct SetLabels {
  Field field;                      // kPart or kMaterial
  std::vector<uint32_t>& priority;  // of the set
};

// Returns nullopt if the set is not labeled.
inline std::optional<SetLabels> LabelsOf(VoxelSet& set) {
  if (auto* const solid = std::get_if<Solid>(&set); solid != nullptr && solid->labels) {
    return SetLabels{*solid->labels, solid->priority};
  }
  if (auto* const enclosed = std::get_if<Enclosed>(&set); enclosed != nullptr && enclosed->labels) {
    return SetLabels{*enclosed->labels, enclosed->priority};
  }
  return std::nullopt;
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_SET_LABELS_H_
