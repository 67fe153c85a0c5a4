#include "client/tool/cli/warnings.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace latvox::client {
namespace {

// Shards may be empty, and then the whole lacks nothing.
bool IsNote(const Warning& warning) { return warning.code == "EMPTY_SHARD"; }

}  // namespace

absl::Status Warn(const std::vector<Warning>& warnings, bool strict,
                  const std::function<void(const std::string& line)>& say) {
  std::vector<std::string> codes;
  for (const Warning& warning : warnings) {
    say(absl::StrCat(IsNote(warning) ? "note: " : "warning: ", warning.message));
    if (!IsNote(warning)) codes.push_back(warning.code);
  }
  if (!strict || codes.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("strict: no warning is allowed, and there is ", absl::StrJoin(codes, ", ")));
}

}  // namespace latvox::client
