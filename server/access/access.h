// Who may connect and call: the files that the options name, and what becomes of them when they change.
#ifndef LATVOX_SERVER_ACCESS_ACCESS_H_
#define LATVOX_SERVER_ACCESS_ACCESS_H_

#include <grpcpp/security/server_credentials.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "server/access/authenticator.h"
#include "server/access/tls_source.h"
#include "server/base/file_watch.h"

namespace latvox {

struct AccessOptions {
  TlsFiles tls;            // for all addresses but Unix sockets
  bool insecure = false;   // plain text also for others than this machine
  std::string token_file;  // who may call, see server/access/token_set.h; empty: everybody
};

// Thread-safe.
class Access {
 public:
  explicit Access(const AccessOptions& options);

  // Reads the files. INVALID_ARGUMENT if one is wrong, or if one of the addresses must not be listened on in plain
  // text.
  absl::Status Open(const std::vector<std::string>& addresses);

  // From now on, files that change are read again. Once, after Open.
  void Follow() { watch_.Start(); }

  // Reads the files again. What is wrong with them is logged, and stays as it was.
  void Reload();

  // For an address to listen on, with a server that this object must outlive. After Open.
  std::shared_ptr<grpc::ServerCredentials> CredentialsFor(const std::string& address);

  const Authenticator& authenticator() const { return authenticator_; }

  // When the server's certificate ends; nothing without TLS.
  std::optional<absl::Time> certificate_expires() const;

 private:
  const bool insecure_;
  Authenticator authenticator_;
  TlsSource tls_;
  FileWatch watch_;  // the first to go: it calls the others
};

}  // namespace latvox

#endif  // LATVOX_SERVER_ACCESS_ACCESS_H_
