// The PEM files of TLS.
#ifndef LATVOX_SERVER_ACCESS_TLS_FILES_H_
#define LATVOX_SERVER_ACCESS_TLS_FILES_H_

#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace latvox {

// Paths.
struct TlsFiles {
  std::string certificate;  // the server's, with those that lead to its root behind it; empty: no TLS
  std::string key;          // of the certificate, without a passphrase
  std::string client_ca;    // roots: each client has to show a certificate that leads to one; empty: none has to
};

// What they hold, good to be used: the key is the certificate's.
struct TlsTexts {
  std::string certificate, key, client_ca;
  absl::Time expires;                // the server's certificate
  bool key_readable_by_all = false;  // by users that neither own it nor are of its group
};

// Errors: INVALID_ARGUMENT naming the file and what is wrong with it, or the option that is missing. Precondition:
// `files.certificate` or another path is not empty.
absl::StatusOr<TlsTexts> ReadTlsFiles(const TlsFiles& files);

}  // namespace latvox

#endif  // LATVOX_SERVER_ACCESS_TLS_FILES_H_
