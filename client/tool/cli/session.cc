#include "client/tool/cli/session.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "client/internal/address.h"
#include "deploy/process/exhaustion.h"

namespace latvox::client {
namespace {

// Strips white space, such as the line end.
absl::StatusOr<std::string> ReadToken(const std::string& path) {
  std::ifstream file(path);
  if (!file) {
    return absl::InvalidArgumentError(
        absl::StrCat("cannot read the token file \"", path, "\": ", std::strerror(errno)));
  }
  std::string token, more;
  if (!(file >> token) || file >> more) {
    return absl::InvalidArgumentError(absl::StrCat("the token file \"", path, "\" does not hold exactly one word"));
  }
  return token;
}

std::string EnvironmentValue(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

}  // namespace

bool HasNetwork(const ServerChoice& choice) {
  if (choice.address.empty()) return false;
  const std::vector<absl::string_view> addresses = absl::StrSplit(choice.address, ',');
  return !std::all_of(addresses.begin(), addresses.end(), IsLocalAddress);
}

absl::Status Session::StartPrivate(const ServerChoice& choice, const CallOptions& options) {
  auto server = PrivateServer::Start({choice.program, choice.threads}, options, [this](const std::string& path) {
    directory_ = std::make_unique<TemporaryDirectoryMark>(path);
  });
  if (!server.ok() && absl::IsUnavailable(server.status())) {
    return absl::UnavailableError(absl::StrCat(server.status().message(), "; or give --server ADDRESS"));
  }
  if (!server.ok()) return server.status();
  server_ = *std::move(server);
  return absl::OkStatus();
}

absl::StatusOr<Session> Session::Open(const ServerChoice& choice, const CallOptions& options) {
  constexpr uint64_t kForThreadsOfGrpc = uint64_t{128} << 20;
  if (absl::Status status = CheckAddresses(kForThreadsOfGrpc); !status.ok()) return status;
  Session session;
  std::string address = choice.address;
  if (address.empty()) {
    if (absl::Status status = session.StartPrivate(choice, options); !status.ok()) return status;
    address = session.server_->address();
  }
  ConnectionOptions connection{.credentials = choice.credentials};
  if (!choice.token_file.empty()) {
    auto token = ReadToken(choice.token_file);
    if (!token.ok()) return token.status();
    connection.credentials.token = *std::move(token);
  }
  auto client = Client::Connect(address, options, connection);
  if (!client.ok()) return client.status();
  if (session.server_) session.server_->RemoveDirectory();
  session.directory_.reset();
  session.client_ = *std::move(client);
  return session;
}

CallOptions MakeCallOptions(const ServerChoice& choice, const Cancellation& cancellation) {
  CallOptions options;
  options.cancellation = cancellation;
  if (choice.retries) options.retry.max_retries = *choice.retries;
  if (choice.address.empty()) options.retry.max_retries = 0;
  if (choice.timeout_seconds) options.deadline = absl::Now() + absl::Seconds(*choice.timeout_seconds);
  options.traceparent = choice.traceparent;
  if (choice.traceparent.empty()) {
    options.traceparent = EnvironmentValue("TRACEPARENT");
    options.tracestate = EnvironmentValue("TRACESTATE");
  }
  return options;
}

}  // namespace latvox::client
