#include "client/cli/session.h"

#include <cstdio>
#include <utility>

namespace latvox::client {

absl::StatusOr<Session> Session::Open(const ServerChoice& choice, const CallOptions& options) {
  Session session;
  std::string address = choice.address;
  if (address.empty()) {
    auto server = PrivateServer::Start(choice.threads, options);
    if (!server.ok()) return server.status();
    session.server_ = *std::move(server);
    address = session.server_->address();
    std::fprintf(stderr, "latvox: no --server given, started a private %s for this call\n",
                 session.server_->program().c_str());
  }
  auto client = Client::Connect(address, options);
  if (!client.ok()) return client.status();
  if (session.server_) session.server_->RemoveDirectory();
  session.client_ = *std::move(client);
  return session;
}

CallOptions MakeCallOptions(const ServerChoice& choice, const Cancellation& cancellation) {
  CallOptions options;
  options.cancellation = cancellation;
  if (choice.retries) options.retry.max_retries = *choice.retries;
  if (choice.address.empty()) options.retry.max_retries = 0;
  if (choice.timeout_seconds) options.deadline = absl::Now() + absl::Seconds(*choice.timeout_seconds);
  return options;
}

}  // namespace latvox::client
