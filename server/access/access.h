// Access control: the files that the options name, and their reload when they change.
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
  TlsFiles tls;               // for all addresses except Unix sockets
  bool insecure = false;      // plain text also for other machines
  bool behind_proxy = false;  // other machines reach the addresses only through a proxy that checks HTTP/2
  std::string token_file;     // tokens of callers, see server/access/token_set.h; empty: everybody may call
};

// Thread-safe.
class Access {
 public:
  explicit Access(const AccessOptions& options);

  // Reads the files. Returns INVALID_ARGUMENT if a file is wrong, or if plain text is not allowed on one of the
  // addresses.
  absl::Status Open(const std::vector<std::string>& addresses);

  // Reads files again when they change, from now on. Call it once, after Open.
  void Follow() { watch_.Start(); }

  // Reads the files again. Logs errors, and keeps the old content of a file that is wrong.
  void Reload();

  // Returns the credentials for an address of a server that this object outlives. Call it after Open.
  std::shared_ptr<grpc::ServerCredentials> CredentialsFor(const std::string& address);

  const Authenticator& authenticator() const { return authenticator_; }

  // The end of validity of the server's certificate; nothing without TLS.
  std::optional<absl::Time> certificate_expires() const;

 private:
  const bool insecure_;
  Authenticator authenticator_;
  TlsSource tls_;
  FileWatch watch_;  // destroyed first, because it calls the others
};

}  // namespace latvox

#endif  // LATVOX_SERVER_ACCESS_ACCESS_H_
