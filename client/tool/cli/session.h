// The server of a command.
#ifndef LATVOX_CLIENT_TOOL_CLI_SESSION_H_
#define LATVOX_CLIENT_TOOL_CLI_SESSION_H_

#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/internal/private_server.h"
#include "client/tool/output/atomic_file.h"
#include "latvox/client.h"

namespace latvox::client {

// Options of every command that uses a server.
struct ServerChoice {
  std::string address;         // one, or several separated by commas; empty: a private server
  std::optional<int> threads;  // of a private server
  std::string program = {};    // of a private server, as PrivateServerOptions has it
  Credentials credentials;     // for a named server
  std::string token_file;      // holds the token; empty: no token
  std::optional<double> timeout_seconds;
  std::string traceparent;     // W3C trace context of all calls; empty: from the environment
  std::optional<int> retries;  // for a named server; a private one that died does not come back
};

// Returns whether a network may be between this program and its server: an address is not a Unix socket or loopback.
bool HasNetwork(const ServerChoice& choice);

class Session {
 public:
  // Connects. Without an address, starts a private server first and prints a line about it on standard error.
  // Errors: as PrivateServer::Start and Client::Connect; INVALID_ARGUMENT if the token file holds no token.
  static absl::StatusOr<Session> Open(const ServerChoice& choice, const CallOptions& options);

  const Client& client() const { return *client_; }

 private:
  absl::Status StartPrivate(const ServerChoice& choice, const CallOptions& options);

  std::unique_ptr<TemporaryDirectoryMark> directory_;  // of the server, while it exists
  // The order matters: the connection is destroyed before its server.
  std::unique_ptr<PrivateServer> server_;
  std::optional<Client> client_;
};

// Returns the options of a call. The deadline counts from now. Without a traceparent in `choice`, passes $TRACEPARENT
// and $TRACESTATE on, as OpenTelemetry's "Environment Variables as Context Propagation Carriers" specifies.
CallOptions MakeCallOptions(const ServerChoice& choice, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_SESSION_H_
