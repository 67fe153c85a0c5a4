// The rules of a request, each stated once. The server applies them for everybody: the SDK and the tool pass its answer
// on, and do not judge.
#ifndef LATVOX_CORE_REQUEST_RULES_H_
#define LATVOX_CORE_REQUEST_RULES_H_

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "core/request/breach.h"
#include "core/request/options.h"

namespace latvox {

// One option's value, whatever the others are.
struct ValueRule {
  std::string_view option;
  std::optional<Breach> (*find)(const VoxelizeOptions& options);
};

// An option as rules about pairs see it.
struct Option {
  std::string_view name;                                 // in `Exclusion`
  std::string_view field;                                // path in the request
  std::string_view words;                                // in documents: "`cover` supercover"
  bool (*is_given)(const VoxelizeOptions& options);      // with a value other than the default
  std::string (*value)(const VoxelizeOptions& options);  // empty if the field says everything
};

// Two options that exclude each other. The message is "<field and value of option>: not together with <field and value
// of other><why>", and blames `option`. proto/README.md has the same table for readers.
struct Exclusion {
  std::string_view option, other;
  std::string_view why = "";
};

// All rules, in the order of their application: first values, then exclusions.
std::span<const ValueRule> ValueRules();
std::span<const Option> Options();
std::span<const Exclusion> Exclusions();

// Returns INVALID_ARGUMENT for the first rule that the options break.
absl::Status CheckRules(const VoxelizeOptions& options);

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_RULES_H_
