// Bearer tokens, as a file lists them. A line for each:
//
//   NAME TOKEN [max-jobs=N] [max-mesh-bytes=N] [max-triangles=N]
//
//   NAME   of the client, for the log and its share of the server: letters, digits, . _ -. To change a token without a
//          gap, a name may have several, on lines of their own.
//   TOKEN  16 to 512 characters of A-Z a-z 0-9 - . _ ~ + / =; or sha256: and the 64 hexadecimal digits of its SHA-256
//          (printf %s "$TOKEN" | sha256sum), so that the file holds no secret.
//
// The limits hold for calls with this token, besides those of the server; bytes may have units, as 64MiB. Empty lines
// and what follows a # at the beginning of a line are ignored.
#ifndef LATVOX_SERVER_ACCESS_TOKEN_SET_H_
#define LATVOX_SERVER_ACCESS_TOKEN_SET_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "server/access/caller.h"

namespace latvox {

// Thread-safe: it does not change. Keeps the tokens' SHA-256 only.
class TokenSet {
 public:
  // Errors: INVALID_ARGUMENT naming the line, never with a part of a token. A file without any token is one, and so is
  // a token that stands twice.
  static absl::StatusOr<TokenSet> Parse(absl::string_view text);

  // Whose token it is; `client` is the name. Takes the same time whatever the set and the token hold, but for the
  // number of tokens and the length of this one.
  std::optional<Caller> Find(absl::string_view token) const;

  size_t size() const { return entries_.size(); }
  // Whether the file shows a token itself.
  bool has_plain_tokens() const { return has_plain_tokens_; }

 private:
  using Sha256 = std::array<uint8_t, 32>;
  struct Entry {
    Sha256 sha256;
    std::string name;
    CallerLimits limits;
  };

  absl::Status AddLine(const std::vector<absl::string_view>& words);
  absl::StatusOr<Sha256> ReadToken(absl::string_view word);
  size_t IndexOf(const Sha256& sha256) const;

  std::vector<Entry> entries_;
  bool has_plain_tokens_ = false;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_ACCESS_TOKEN_SET_H_
