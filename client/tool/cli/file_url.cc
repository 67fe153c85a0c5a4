#include "client/tool/cli/file_url.h"

#include <charconv>
#include <filesystem>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/tool/remote/remote_name.h"

namespace latvox::client {
namespace {

template <class... Parts>
absl::Status WrongUrl(const std::string& text, const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat("\"", Redact(text), "\": ", parts...));
}

// Returns the scheme in lower case, if the text has one: "file:", or the text before "://".
std::string SchemeOf(const std::string& text) {
  const size_t colon = text.find(':');
  if (colon == std::string::npos || colon == 0) return "";
  std::string scheme = absl::AsciiStrToLower(text.substr(0, colon));
  if (scheme.find('/') != std::string::npos) return "";
  return scheme == "file" || absl::StartsWith(text.substr(colon), "://") ? scheme : "";
}

absl::StatusOr<std::string> Decode(absl::string_view encoded, const std::string& text) {
  std::string path;
  for (size_t n = 0; n < encoded.size(); ++n) {
    if (encoded[n] != '%') {
      path += encoded[n];
      continue;
    }
    unsigned char byte = 0;
    const absl::string_view digits = encoded.substr(n + 1, 2);
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16);
    if (digits.size() < 2 || error != std::errc() || end != digits.data() + 2) {
      return WrongUrl(text, "% is not followed by two hexadecimal digits");
    }
    path += static_cast<char>(byte);
    n += 2;
  }
  return path;
}

}  // namespace

absl::StatusOr<std::string> PathOf(const std::string& text, const std::string& folder) {
  const std::string scheme = SchemeOf(text);
  absl::StatusOr<std::string> path = text;
  if (!scheme.empty()) {
    if (scheme != "file") return WrongUrl(text, "scheme \"", scheme, "\" is not file, https, http or s3");
    absl::string_view rest = absl::string_view(text).substr(text.find(':') + 1);
    if (absl::ConsumePrefix(&rest, "//")) absl::ConsumePrefix(&rest, "localhost");
    if (!absl::StartsWith(rest, "/"))
      return WrongUrl(text, "is not file:///PATH, with an absolute path on this machine");
    path = Decode(rest, text);
  }
  if (path.ok() && absl::StrContains(*path, '\0')) return WrongUrl(text, "contains a NUL");
  if (path.ok()) path = (std::filesystem::path(folder) / *path).string();
  return path;
}

}  // namespace latvox::client
