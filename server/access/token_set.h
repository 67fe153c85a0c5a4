// Bearer tokens, as a file lists them. A line for each:
//
//   NAME TOKEN [max-jobs=N] [max-job-seconds=N] [max-mesh-bytes=N] [max-triangles=N]
//
//   NAME   the client, for the log and its share of the server: letters, digits, . _ -. A name may have several tokens,
//          each on a line of its own, so that a token can be changed without a gap.
//   TOKEN  16 to 512 characters of A-Z a-z 0-9 - . _ ~ + / =; or sha256: and the 64 hexadecimal digits of its SHA-256
//          (printf %s "$TOKEN" | sha256sum), so that the file holds no secret.
//
// The limits hold for calls with this token, besides those of the server. Bytes may have units, such as 64MiB. Empty
// lines and lines that begin with # are ignored.
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

// Thread-safe, because it does not change. It keeps only the SHA-256 of each token.
class TokenSet {
 public:
  // Errors: INVALID_ARGUMENT naming the line, never with a part of a token. A file without any token is an error, and
  // so is a token that occurs twice.
  static absl::StatusOr<TokenSet> Parse(absl::string_view text);

  // Returns the caller with this token; `client` is the name. The time depends only on the number of tokens and the
  // length of this one.
  std::optional<Caller> Find(absl::string_view token) const;

  size_t size() const { return entries_.size(); }
  // Whether the file holds a token in plain text.
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
