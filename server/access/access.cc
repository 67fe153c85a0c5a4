#include "server/access/access.h"

#include "server/base/endpoint.h"
#include "server/base/unix_socket.h"

namespace latvox {

Access::Access(const AccessOptions& options)
    : insecure_(options.insecure), authenticator_(options.token_file), tls_(options.tls) {
  watch_.Add({options.token_file}, [this] { authenticator_.Reload(); });
  watch_.Add({options.tls.certificate, options.tls.key, options.tls.client_ca}, [this] { tls_.Reload(); });
}

absl::Status Access::Open(const std::vector<std::string>& addresses) {
  if (absl::Status status = authenticator_.Read(); !status.ok()) return status;
  if (absl::Status status = tls_.Read(); !status.ok()) return status;
  for (const std::string& address : addresses) {
    if (absl::Status status = CheckProtected(address, tls_.enabled(), insecure_); !status.ok()) return status;
  }
  return absl::OkStatus();
}

void Access::Reload() {
  authenticator_.Reload();
  tls_.Reload();
}

// The file system decides who can reach a Unix socket.
std::shared_ptr<grpc::ServerCredentials> Access::CredentialsFor(const std::string& address) {
  return tls_.enabled() && !IsUnixSocket(address) ? tls_.Credentials() : grpc::InsecureServerCredentials();
}

std::optional<absl::Time> Access::certificate_expires() const {
  return tls_.enabled() ? std::optional(tls_.expires()) : std::nullopt;
}

}  // namespace latvox
