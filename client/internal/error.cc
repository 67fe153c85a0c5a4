#include "latvox/error.h"

#include <string>

#include "absl/strings/string_view.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace latvox::client {
namespace {

// The payloads of a status: one text for each detail, because absl::Status prints its payloads.
constexpr char kReason[] = "latvox.reason", kField[] = "latvox.field", kValue[] = "latvox.value",
               kLimit[] = "latvox.limit", kOther[] = "latvox.other", kRetryAfter[] = "latvox.retry_after";

std::string Find(const google::rpc::ErrorInfo& info, const char* key) {
  const auto found = info.metadata().find(key);
  return found == info.metadata().end() ? std::string() : found->second;
}

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

void AttachWireDetails(const std::string& serialized_rpc_status, absl::Status& status) {
  google::rpc::Status rpc_status;
  if (status.ok() || !rpc_status.ParseFromString(serialized_rpc_status)) return;
  ErrorDetails details = GetErrorDetails(status);
  for (const auto& detail : rpc_status.details()) {
    google::rpc::ErrorInfo info;
    google::rpc::RetryInfo retry;
    if (detail.Is<google::rpc::ErrorInfo>() && detail.UnpackTo(&info)) {
      details.reason = info.reason();
      details.field = Find(info, "field");
      details.value = Find(info, "value");
      details.limit = Find(info, "limit");
      details.other = Find(info, "other");
    } else if (detail.Is<google::rpc::RetryInfo>() && detail.UnpackTo(&retry) && retry.has_retry_delay()) {
      details.retry_after =
          absl::Seconds(retry.retry_delay().seconds()) + absl::Nanoseconds(retry.retry_delay().nanos());
    }
  }
  SetErrorDetails(details, status);
}

}  // namespace latvox::client
