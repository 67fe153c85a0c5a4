#include "client/tool/cli/exit_status.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "client/internal/printable.h"
#include "latvox/error.h"

namespace latvox::client {

ExitStatus ExitStatusOf(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kOk:
      return ExitStatus::kDone;
    case absl::StatusCode::kInvalidArgument:
      // Options that exclude each other are wrong usage, even if the server finds it.
      return GetErrorDetails(status).other.empty() ? ExitStatus::kBadInput : ExitStatus::kWrongUsage;
    case absl::StatusCode::kNotFound:
      return ExitStatus::kBadInput;
    case absl::StatusCode::kUnavailable:
      return ExitStatus::kUnreachable;
    case absl::StatusCode::kResourceExhausted:
    case absl::StatusCode::kUnauthenticated:
      return ExitStatus::kRefused;
    case absl::StatusCode::kCancelled:
    case absl::StatusCode::kDeadlineExceeded:
      return ExitStatus::kCancelled;
    default:
      return ExitStatus::kOther;
  }
}

std::string ErrorText(const absl::Status& status) {
  std::string line(status.message());
  const auto append = [&line](absl::string_view name, absl::string_view value) {
    if (!value.empty() && !absl::StrContains(line, value)) absl::StrAppend(&line, " (", name, " ", value, ")");
  };
  const ErrorDetails details = GetErrorDetails(status);
  const bool names_file = !details.value.empty() && absl::StrContains(line, absl::StrCat(details.value, ": "));
  if (!names_file) {  // else it tells what is wrong with the file
    append("field", details.field);
    append("value", details.value);
    append("limit", details.limit);
  }
  if (details.retry_after) append("try again in", absl::FormatDuration(*details.retry_after));
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return Printable(line);  // a foreign file may have put bytes into it that change the terminal
}

}  // namespace latvox::client
