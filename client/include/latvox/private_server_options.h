// Options of a private server.
#ifndef LATVOX_LATVOX_PRIVATE_SERVER_OPTIONS_H_
#define LATVOX_LATVOX_PRIVATE_SERVER_OPTIONS_H_

#include <optional>
#include <string>

namespace latvox::client {

// All are optional.
struct PrivateServerOptions {
  // The program latvoxd. Default: $LATVOX_LATVOXD, otherwise the latvoxd beside this program, otherwise the one in
  // PATH.
  std::string program = {};
  std::optional<int> threads = std::nullopt;  // of the server; default: as many as the machine has
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_PRIVATE_SERVER_OPTIONS_H_
