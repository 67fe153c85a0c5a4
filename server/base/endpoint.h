// Addresses to listen on.
#ifndef LATVOX_SERVER_BASE_ENDPOINT_H_
#define LATVOX_SERVER_BASE_ENDPOINT_H_

#include <grpcpp/server_builder.h>

#include <string>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace latvox {

// unix:PATH and unix-abstract:NAME.
bool IsUnixSocket(absl::string_view address);

// Whether only this machine can connect to it: a Unix socket, a loopback address, or localhost.
bool IsLocal(const std::string& address);

// INVALID_ARGUMENT, naming address and options, unless it is local or TLS or the operator's word protect it. `tls` and
// `insecure` together are a contradiction, and refused.
absl::Status CheckProtected(const std::string& address, bool tls, bool insecure);

// "HOST:0" with the port that was chosen; others as they are.
std::string BoundAddress(const std::string& address, int port);

// INVALID_ARGUMENT if it is neither HOST:PORT nor unix:PATH.
absl::Status CheckAddress(const std::string& address);

// UNAVAILABLE naming the address, and why; by default, what may be the reason.
absl::Status CannotListen(const std::string& address,
                          absl::string_view why = "the address is in use, not of this machine, or not permitted");

// gRPC unpacks a message before it looks at its size: a megabyte may become a gigabyte.
void WithoutCompression(grpc::ServerBuilder& builder);

// As CannotListen, if it is a Unix socket that CheckSocketPathIsFree finds fault with. Of other addresses, gRPC tells.
absl::Status CheckAddressIsFree(const std::string& address);

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_ENDPOINT_H_
