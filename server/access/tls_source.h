// TLS with certificates that may change while the server runs.
#ifndef LATVOX_SERVER_ACCESS_TLS_SOURCE_H_
#define LATVOX_SERVER_ACCESS_TLS_SOURCE_H_

#include <grpcpp/security/server_credentials.h>

#include <memory>
#include <vector>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "server/access/tls_files.h"

namespace latvox {

// Thread-safe. TLS 1.2 and 1.3.
class TlsSource {
 public:
  explicit TlsSource(const TlsFiles& files);
  ~TlsSource();

  bool enabled() const { return !files_.certificate.empty(); }

  // Reads the files. Errors: as ReadTlsFiles; then the old content stays. Does nothing if no path is given.
  absl::Status Read();

  // Does the same, and logs the result.
  void Reload();

  // The end of validity of the certificate in use. InfiniteFuture without TLS.
  absl::Time expires() const;

  // Returns the credentials of one port, whose server this object outlives. Each new connection gets the certificate
  // that was read last; existing connections go on. Call it after Read, on one thread.
  std::shared_ptr<grpc::ServerCredentials> Credentials();

 private:
  struct Current;

  const TlsFiles files_;
  const std::shared_ptr<Current> current_;
  // A server does not keep its ports' credentials, but asks them for certificates to its end.
  std::vector<std::shared_ptr<grpc::ServerCredentials>> credentials_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_ACCESS_TLS_SOURCE_H_
