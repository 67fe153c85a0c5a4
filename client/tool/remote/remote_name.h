// Names of objects on other machines: s3://BUCKET/KEY, https: URLs, and http: URLs.
#ifndef LATVOX_CLIENT_TOOL_REMOTE_REMOTE_NAME_H_
#define LATVOX_CLIENT_TOOL_REMOTE_REMOTE_NAME_H_

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

struct RemoteName {
  // The text without query and fragment. Everything that people or programs read has this name, because the query of a
  // presigned URL lets its reader in.
  std::string name;
  std::string url;          // https or http: as given, without the fragment; empty for s3
  std::string bucket, key;  // s3 alone; the key is taken as it is, without % escapes

  bool is_s3() const { return url.empty(); }
};

// Returns whether the text has one of the schemes above, in any case.
bool IsRemote(absl::string_view text);

// Errors: INVALID_ARGUMENT, with the name alone: no bucket, key, host or file name; a user or password in the URL; a
// space or control character in a URL. Whether http: is allowed is a question of the call.
absl::StatusOr<RemoteName> ParseRemote(absl::string_view text);

// Returns the text with the user, query and fragment of each URL in it replaced by "...".
std::string Redact(absl::string_view text);

// Returns an https: or http: URL up to its query or fragment, and another text as it is.
std::string WithoutQuery(absl::string_view text);

// Returns the last part of the name, with % escapes of a URL decoded, as the name of a file.
std::string FileNameOf(const RemoteName& remote);

// Returns the text with all bytes except letters, digits and -._~ as %XX. `keep_slash`: except / as well.
std::string Escape(absl::string_view text, bool keep_slash);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_REMOTE_REMOTE_NAME_H_
