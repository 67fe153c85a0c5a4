// Authentication of callers by tokens.
#ifndef LATVOX_SERVER_ACCESS_AUTHENTICATOR_H_
#define LATVOX_SERVER_ACCESS_AUTHENTICATOR_H_

#include <grpcpp/server_context.h>

#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "server/access/caller.h"
#include "server/access/token_set.h"

namespace latvox {

// Thread-safe.
class Authenticator {
 public:
  // `token_file`: see server/access/token_set.h. Nobody may call before it is read. Empty: everybody may call.
  explicit Authenticator(std::string token_file) : token_file_(std::move(token_file)) {}

  // Reads the file. Returns INVALID_ARGUMENT naming the file if it is wrong, and keeps the old tokens.
  absl::Status Read();

  // Does the same, and logs the result.
  void Reload();

  // Returns UNAUTHENTICATED, always in the same words, unless the call's metadata has one valid bearer token.
  absl::StatusOr<Caller> Authenticate(const grpc::CallbackServerContext& context) const;

 private:
  std::shared_ptr<const TokenSet> tokens() const;

  const std::string token_file_;
  mutable std::mutex mu_;
  std::shared_ptr<const TokenSet> tokens_;  // guarded by mu_; null: no file was read
};

}  // namespace latvox

#endif  // LATVOX_SERVER_ACCESS_AUTHENTICATOR_H_
