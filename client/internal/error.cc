#include "latvox/error.h"

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace latvox::client {
namespace {

constexpr char kErrorInfoType[] = "type.googleapis.com/google.rpc.ErrorInfo";
constexpr char kRetryInfoType[] = "type.googleapis.com/google.rpc.RetryInfo";

std::string Find(const google::rpc::ErrorInfo& info, const char* key) {
  const auto found = info.metadata().find(key);
  return found == info.metadata().end() ? std::string() : found->second;
}

}  // namespace

ErrorDetails GetErrorDetails(const absl::Status& status) {
  ErrorDetails details;
  google::rpc::ErrorInfo info;
  if (const auto payload = status.GetPayload(kErrorInfoType); payload && info.ParseFromString(std::string(*payload))) {
    details.reason = info.reason();
    details.field = Find(info, "field");
    details.value = Find(info, "value");
    details.limit = Find(info, "limit");
    details.other = Find(info, "other");
  }
  google::rpc::RetryInfo retry;
  if (const auto payload = status.GetPayload(kRetryInfoType);
      payload && retry.ParseFromString(std::string(*payload)) && retry.has_retry_delay()) {
    details.retry_after = absl::Seconds(retry.retry_delay().seconds()) + absl::Nanoseconds(retry.retry_delay().nanos());
  }
  return details;
}

void SetErrorDetails(const ErrorDetails& details, absl::Status& status) {
  google::rpc::ErrorInfo info;
  info.set_domain("latvox");
  info.set_reason(details.reason);
  (*info.mutable_metadata())["field"] = details.field;
  (*info.mutable_metadata())["value"] = details.value;
  (*info.mutable_metadata())["limit"] = details.limit;
  if (!details.other.empty()) (*info.mutable_metadata())["other"] = details.other;
  status.SetPayload(kErrorInfoType, absl::Cord(info.SerializeAsString()));
  status.ErasePayload(kRetryInfoType);
  if (!details.retry_after) return;
  google::rpc::RetryInfo retry;
  retry.mutable_retry_delay()->set_seconds(absl::ToInt64Seconds(*details.retry_after));
  retry.mutable_retry_delay()->set_nanos(
      static_cast<int32_t>(absl::ToInt64Nanoseconds(*details.retry_after % absl::Seconds(1))));
  status.SetPayload(kRetryInfoType, absl::Cord(retry.SerializeAsString()));
}

void AttachWireDetails(const std::string& serialized_rpc_status, absl::Status& status) {
  google::rpc::Status rpc_status;
  if (status.ok() || !rpc_status.ParseFromString(serialized_rpc_status)) return;
  for (const auto& detail : rpc_status.details()) {
    if (detail.type_url() == kErrorInfoType || detail.type_url() == kRetryInfoType) {
      status.SetPayload(detail.type_url(), absl::Cord(detail.value()));
    }
  }
}

}  // namespace latvox::client
