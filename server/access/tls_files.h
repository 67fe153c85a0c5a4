// PEM files of TLS.
#ifndef LATVOX_SERVER_ACCESS_TLS_FILES_H_
#define LATVOX_SERVER_ACCESS_TLS_FILES_H_

#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace latvox {

// Paths.
struct TlsFiles {
  std::string certificate;  // the server's certificate, followed by the chain to its root; empty: no TLS
  std::string key;          // of the certificate, without a passphrase
  std::string
      client_ca;  // root certificates: each client must show a certificate that leads to one; empty: no client must
};

// The content of the files, checked: the key belongs to the certificate.
struct TlsTexts {
  std::string certificate, key, client_ca;
  absl::Time expires;                // of the server's certificate
  bool key_readable_by_all = false;  // by users who neither own it nor belong to its group
};

// Errors: INVALID_ARGUMENT naming the file and its fault, or the missing option. Precondition: at least one path is not
// empty.
absl::StatusOr<TlsTexts> ReadTlsFiles(const TlsFiles& files);

}  // namespace latvox

#endif  // LATVOX_SERVER_ACCESS_TLS_FILES_H_
