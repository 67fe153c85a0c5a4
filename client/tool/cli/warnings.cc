#include "client/tool/cli/warnings.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace latvox::client {

absl::Status Warn(const std::vector<Warning>& warnings, bool strict,
                  const std::function<void(const std::string& line)>& say) {
  for (const Warning& warning : warnings) say(absl::StrCat("warning: ", warning.message));
  if (!strict || warnings.empty()) return absl::OkStatus();
  const auto code = [](std::string* out, const Warning& warning) { *out += warning.code; };
  return absl::InvalidArgumentError(
      absl::StrCat("strict: no warning is allowed, and there is ", absl::StrJoin(warnings, ", ", code)));
}

}  // namespace latvox::client
