// Addresses that a server listens on.
#ifndef LATVOX_SERVER_BASE_ENDPOINT_H_
#define LATVOX_SERVER_BASE_ENDPOINT_H_

#include <grpcpp/server_builder.h>

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace latvox {

// True for unix:PATH and unix-abstract:NAME.
bool IsUnixSocket(absl::string_view address);

// Returns whether only this machine can connect to the address: a Unix socket, a loopback address, or localhost.
bool IsLocal(const std::string& address);

// Returns INVALID_ARGUMENT, naming address and options, unless the address is local, uses TLS, or the operator has
// allowed plain text. `tls` and `insecure` together are refused as a contradiction.
absl::Status CheckProtected(const std::string& address, bool tls, bool insecure);

// Returns "HOST:0" with the port that was chosen, and other addresses unchanged.
std::string BoundAddress(const std::string& address, int port);

// Returns INVALID_ARGUMENT if the address is neither HOST:PORT nor unix:PATH.
absl::Status CheckAddress(const std::string& address);

// Returns UNAVAILABLE with the address and the reason; the default is the most likely reason.
absl::Status CannotListen(const std::string& address,
                          absl::string_view why = "the address is in use, not of this machine, or not permitted");

// gRPC decompresses a message before it checks the size: a megabyte may become a gigabyte.
void WithoutCompression(grpc::ServerBuilder& builder);

// Returns the error of CheckSocketPathIsFree for a Unix socket. For other addresses, gRPC reports the error.
absl::Status CheckAddressIsFree(const std::string& address);

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_ENDPOINT_H_
