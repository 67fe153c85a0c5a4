#include <string>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

std::string FindText(const google::rpc::ErrorInfo& info, const char* key) {
  const auto found = info.metadata().find(key);
  return found == info.metadata().end() ? std::string() : found->second;
}

}  // namespace

void AttachWireDetails(const std::string& serialized_rpc_status, absl::Status& status) {
  google::rpc::Status rpc_status;
  if (status.ok() || !rpc_status.ParseFromString(serialized_rpc_status)) return;
  ErrorDetails details = GetErrorDetails(status);
  for (const auto& detail : rpc_status.details()) {
    google::rpc::ErrorInfo info;
    google::rpc::RetryInfo retry;
    if (detail.Is<google::rpc::ErrorInfo>() && detail.UnpackTo(&info)) {
      details.reason = info.reason();
      details.field = FindText(info, "field");
      details.value = FindText(info, "value");
      details.limit = FindText(info, "limit");
      details.other = FindText(info, "other");
    } else if (detail.Is<google::rpc::RetryInfo>() && detail.UnpackTo(&retry) && retry.has_retry_delay()) {
      details.retry_after =
          absl::Seconds(retry.retry_delay().seconds()) + absl::Nanoseconds(retry.retry_delay().nanos());
    }
  }
  SetErrorDetails(details, status);
}

}  // namespace latvox::client
