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
  // Starts a private server if `choice` has no address. So the server gets ready while its user reads a mesh. Connect
  // tells its errors.
  explicit Session(const ServerChoice& choice);

  // Connects. Errors: as PrivateServer and Client::Connect; INVALID_ARGUMENT if the token file holds no token.
  absl::Status Connect(const CallOptions& options);

  // Does both.
  static absl::StatusOr<Session> Open(const ServerChoice& choice, const CallOptions& options);

  // Ends the connection. A private server then ends while this process does other work; the destructor waits for it.
  // Precondition: no call runs.
  void Disconnect();

  // Precondition: connected.
  const Client& client() const { return *client_; }

 private:
  absl::StatusOr<std::string> Address(const CallOptions& options) const;

  ServerChoice choice_;
  absl::Status started_;
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
