// Credentials of the client, and those that it requires of a server.
#ifndef LATVOX_LATVOX_CREDENTIALS_H_
#define LATVOX_LATVOX_CREDENTIALS_H_

#include <string>

namespace latvox::client {

// Files are PEM, and are read when the client connects. Any file turns TLS on, and so does `tls` alone.
struct Credentials {
  bool tls = false;           // the connection is encrypted, and the server proves its name
  std::string tls_ca_file;    // roots for the server's certificate; empty: the system's
  std::string tls_cert_file;  // the client's own certificate, for a server that requires one
  std::string tls_key_file;   // the key of that certificate; INVALID_ARGUMENT if only one of the two is set
  std::string token;          // bearer token; empty: none. Never sent in plain text, except to this machine
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_CREDENTIALS_H_
