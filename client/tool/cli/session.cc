#include "client/tool/cli/session.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/string_view.h"
#include "absl/strings/strip.h"
#include "client/internal/address.h"
#include "client/internal/file_error.h"
#include "deploy/process/exhaustion.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

// Strips white space, such as the line end.
absl::StatusOr<std::string> ReadToken(const std::string& path) {
  const auto wrong = [&path](absl::string_view what) {
    return WithFile(absl::InvalidArgumentError(absl::StrCat(path, ": ", what)), "--token-file", path,
                    "a file with one word, the token");
  };
  std::ifstream file(path);
  if (!file) return wrong(absl::StrCat("cannot be read (", std::strerror(errno), ")"));
  std::string token, more;
  if (!(file >> token) || file >> more) return wrong("does not hold exactly one word, the token");
  return token;
}

// Returns the error with the option that sets the wrong field of Credentials.
absl::Status WithCredentialOption(absl::Status error, const std::string& token_file) {
  ErrorDetails details = GetErrorDetails(error);
  if (details.field == "token" && !token_file.empty()) {
    details.field = "--token-file";
    details.value = token_file;
  } else if (absl::StartsWith(details.field, "tls_")) {
    details.field = absl::StrCat("--", absl::StrReplaceAll(absl::StripSuffix(details.field, "_file"), {{"_", "-"}}));
  } else {
    return error;
  }
  SetErrorDetails(details, error);
  return error;
}

// Returns the number of threads of a gRPC client and of a private server that computes. Without its threads, gRPC waits
// forever when it ends.
int ThreadsOfCalls() {
  constexpr int kOthers = 20;  // timers, executors, and those that a large job starts
  return kOthers + static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 2U, 32U));
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

Session::Session(const ServerChoice& choice) : choice_(choice) {
  constexpr uint64_t kForThreadsOfGrpc = uint64_t{128} << 20;
  started_ = CheckAddresses(kForThreadsOfGrpc);
  if (!started_.ok() || !choice.address.empty()) return;
  auto server = PrivateServer::Start({choice.program, choice.threads}, [this](const std::string& path) {
    directory_ = std::make_unique<TemporaryDirectoryMark>(path);
  });
  started_ = server.status();
  if (server.ok()) server_ = *std::move(server);
}

// Waits for a private server.
absl::StatusOr<std::string> Session::Address(const CallOptions& options) const {
  if (!choice_.address.empty()) return choice_.address;
  const absl::Status status = server_ ? server_->AwaitReady(options) : started_;
  if (absl::IsUnavailable(status)) {
    return absl::UnavailableError(absl::StrCat(status.message(), "; --server ADDRESS names one that runs"));
  }
  if (!status.ok()) return status;
  return server_->address();
}

absl::Status Session::Connect(const CallOptions& options) {
  const auto address = Address(options);
  if (!address.ok()) return address.status();
  // A private server has its threads by now; they count as well.
  if (absl::Status status = CheckThreads(ThreadsOfCalls()); !status.ok()) return status;
  ConnectionOptions connection{.credentials = choice_.credentials};
  if (!choice_.token_file.empty()) {
    auto token = ReadToken(choice_.token_file);
    if (!token.ok()) return token.status();
    connection.credentials.token = *std::move(token);
  }
  auto client = Client::Connect(*address, options, connection);
  if (!client.ok()) return WithCredentialOption(client.status(), choice_.token_file);
  if (server_) server_->RemoveDirectory();
  directory_.reset();
  client_ = *std::move(client);
  return absl::OkStatus();
}

void Session::Disconnect() {
  client_.reset();
  if (server_) server_->End();
}

absl::StatusOr<Session> Session::Open(const ServerChoice& choice, const CallOptions& options) {
  Session session(choice);
  if (absl::Status status = session.Connect(options); !status.ok()) return status;
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
