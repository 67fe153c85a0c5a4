#include "latvox/error.h"

#include <string>

#include "absl/strings/string_view.h"

namespace latvox::client {
namespace {

// The payloads of a status: one text for each detail, because absl::Status prints its payloads.
constexpr char kReason[] = "latvox.reason", kField[] = "latvox.field", kValue[] = "latvox.value",
               kLimit[] = "latvox.limit", kOther[] = "latvox.other", kRetryAfter[] = "latvox.retry_after";

std::string Get(const absl::Status& status, const char* name) {
  return std::string(status.GetPayload(name).value_or(absl::Cord()));
}

void Set(const char* name, absl::string_view text, absl::Status& status) {
  status.ErasePayload(name);
  if (!text.empty()) status.SetPayload(name, absl::Cord(text));
}

}  // namespace

ErrorDetails GetErrorDetails(const absl::Status& status) {
  ErrorDetails details{.reason = Get(status, kReason),
                       .field = Get(status, kField),
                       .value = Get(status, kValue),
                       .limit = Get(status, kLimit),
                       .retry_after = std::nullopt,
                       .other = Get(status, kOther)};
  absl::Duration retry_after;
  if (absl::ParseDuration(Get(status, kRetryAfter), &retry_after)) details.retry_after = retry_after;
  return details;
}

void SetErrorDetails(const ErrorDetails& details, absl::Status& status) {
  Set(kReason, details.reason, status);
  Set(kField, details.field, status);
  Set(kValue, details.value, status);
  Set(kLimit, details.limit, status);
  Set(kOther, details.other, status);
  Set(kRetryAfter, details.retry_after ? absl::FormatDuration(*details.retry_after) : "", status);
}

}  // namespace latvox::client
