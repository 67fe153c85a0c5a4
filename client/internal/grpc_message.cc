#include "client/internal/grpc_message.h"

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/strip.h"
#include "client/internal/printable.h"

namespace latvox::client {
namespace {

constexpr absl::string_view kLastError = "last error: ";

}  // namespace

std::string ConnectionReason(absl::string_view message) {
  const size_t last = message.find(kLastError);
  if (last != absl::string_view::npos) message.remove_prefix(last + kLastError.size());
  for (const absl::string_view code : {"UNKNOWN: ", "UNAVAILABLE: "}) absl::ConsumePrefix(&message, code);
  const size_t cause = message.rfind(": ");
  const bool has_no_address = absl::StartsWith(message, "DNS resolution failed") && cause != absl::string_view::npos;
  if (has_no_address) message.remove_prefix(cause + 2);
  return absl::StrReplaceAll(message, {{"\n", " "}, {"Failed to connect to remote host: ", ""}});
}

std::string MessageOf(const grpc::Status& status) {
  const std::string message = Printable(status.error_message());
  if (status.error_code() == grpc::StatusCode::UNIMPLEMENTED && message.empty()) {
    return "the server does not offer this call (UNIMPLEMENTED); a health port offers health checks alone";
  }
  if (message.empty()) {
    const auto code = static_cast<absl::StatusCode>(status.error_code());
    return absl::StrCat("the server gave no reason (", absl::StatusCodeToString(code), ")");
  }
  if (!absl::StrContains(message, kLastError)) return message;
  return absl::StrCat("no server can be reached (", Printable(ConnectionReason(status.error_message())), ")");
}

}  // namespace latvox::client
