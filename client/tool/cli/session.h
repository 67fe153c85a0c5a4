// The server that a command talks to.
#ifndef LATVOX_CLIENT_TOOL_CLI_SESSION_H_
#define LATVOX_CLIENT_TOOL_CLI_SESSION_H_

#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/tool/cli/private_server.h"
#include "latvox/client.h"

namespace latvox::client {

// The options that every command with a server has.
struct ServerChoice {
  std::string address;         // one, or several with commas; empty: a private server
  std::optional<int> threads;  // of a private server
  Credentials credentials;     // for a server that was named
  std::string token_file;      // holds their token; empty: there is none
  std::optional<double> timeout_seconds;
  std::string traceparent;     // W3C trace context of all calls; empty: that of the environment, if it has one
  std::optional<int> retries;  // of a server that was named; a private one that has died does not come back
};

class Session {
 public:
  // Connects, and starts a private server before if none was named, of which it tells on standard error.
  // Errors: as PrivateServer::Start and Client::Connect; INVALID_ARGUMENT if the token file holds no token.
  static absl::StatusOr<Session> Open(const ServerChoice& choice, const CallOptions& options);

  const Client& client() const { return *client_; }

 private:
  // In this order: the connection goes before its server.
  std::unique_ptr<PrivateServer> server_;
  std::optional<Client> client_;
};

// The deadline counts from now. Without a traceparent of the choice, $TRACEPARENT and $TRACESTATE are passed on, as
// OpenTelemetry's "Environment Variables as Context Propagation Carriers" has them.
CallOptions MakeCallOptions(const ServerChoice& choice, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_SESSION_H_
