// What a client shows to a server, and wants to see of it.
#ifndef LATVOX_LATVOX_CREDENTIALS_H_
#define LATVOX_LATVOX_CREDENTIALS_H_

#include <string>

namespace latvox::client {

// Files are PEM, and read when the client connects. Naming any of them asks for TLS, as `tls` alone does.
struct Credentials {
  bool tls = false;           // the connection is encrypted, and the server proves its name
  std::string tls_ca_file;    // roots that the server's certificate has to lead to; empty: the system's
  std::string tls_cert_file;  // the client's own certificate, for a server that wants one, with
  std::string tls_key_file;   // its key
  std::string token;          // bearer token; empty: none. Never sent in plain text, but to this machine
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_CREDENTIALS_H_
