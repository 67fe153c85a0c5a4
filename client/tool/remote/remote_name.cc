#include "client/tool/remote/remote_name.h"

#include <algorithm>
#include <charconv>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"

namespace latvox::client {
namespace {

constexpr absl::string_view kSchemes[] = {"s3://", "https://", "http://"};

absl::Status Wrong(absl::string_view text, absl::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat("\"", Redact(text), "\": ", why));
}

bool IsUrlByte(char c) { return absl::ascii_isgraph(static_cast<unsigned char>(c)) && c != '"' && c != '\\'; }

absl::StatusOr<RemoteName> ParseS3(absl::string_view text) {
  const absl::string_view rest = text.substr(kSchemes[0].size());
  const size_t slash = rest.find('/');
  RemoteName remote;
  remote.bucket = std::string(rest.substr(0, slash));
  if (slash != absl::string_view::npos) remote.key = std::string(rest.substr(slash + 1));
  const auto of_bucket = [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '.' || c == '_';
  };
  if (remote.bucket.empty() || !std::all_of(remote.bucket.begin(), remote.bucket.end(), of_bucket)) {
    return Wrong(text, "is not s3://BUCKET/KEY; a bucket has letters, digits and -._");
  }
  if (remote.key.empty() || absl::EndsWith(remote.key, "/")) return Wrong(text, "has no file name after the bucket");
  const auto is_control = [](char c) { return absl::ascii_iscntrl(static_cast<unsigned char>(c)); };
  if (std::any_of(remote.key.begin(), remote.key.end(), is_control)) return Wrong(text, "has a control character");
  for (const absl::string_view part : absl::StrSplit(remote.key, '/')) {
    if (part == "." || part == "..") return Wrong(text, absl::StrCat("has a key with the part \"", part, "\""));
  }
  remote.name = absl::StrCat("s3://", rest);
  return remote;
}

absl::StatusOr<RemoteName> ParseUrl(absl::string_view text) {
  if (!std::all_of(text.begin(), text.end(), IsUrlByte)) {
    return Wrong(text, "has a byte that a URL writes as %XX, such as a space");
  }
  RemoteName remote;
  remote.url = std::string(text.substr(0, text.find('#')));
  remote.name = remote.url.substr(0, remote.url.find('?'));
  const absl::string_view rest = absl::string_view(remote.name).substr(remote.name.find("//") + 2);
  const absl::string_view host = rest.substr(0, rest.find('/'));
  if (absl::StrContains(host, '@')) return Wrong(text, "has a user or password, which would show in results");
  if (host.empty()) return Wrong(text, "has no host");
  if (host.size() == rest.size() || absl::EndsWith(rest, "/")) return Wrong(text, "has no file name at its end");
  return remote;
}

}  // namespace

bool IsRemote(absl::string_view text) {
  return std::any_of(std::begin(kSchemes), std::end(kSchemes),
                     [text](absl::string_view scheme) { return absl::StartsWithIgnoreCase(text, scheme); });
}

absl::StatusOr<RemoteName> ParseRemote(absl::string_view text) {
  return absl::StartsWithIgnoreCase(text, kSchemes[0]) ? ParseS3(text) : ParseUrl(text);
}

std::string Redact(absl::string_view text) {
  constexpr absl::string_view kBeforeHost = "://";
  std::string shown;
  for (size_t at = text.find(kBeforeHost); at != absl::string_view::npos; at = text.find(kBeforeHost)) {
    at += kBeforeHost.size();
    absl::StrAppend(&shown, text.substr(0, at));
    text.remove_prefix(at);
    absl::string_view url = text.substr(0, std::find_if_not(text.begin(), text.end(), IsUrlByte) - text.begin());
    text.remove_prefix(url.size());
    const absl::string_view host = url.substr(0, url.find_first_of("/?#"));
    if (const size_t user = host.rfind('@'); user != absl::string_view::npos) {
      shown += "...";
      url.remove_prefix(user);
    }
    const size_t query = url.find_first_of("?#");
    absl::StrAppend(&shown, url.substr(0, query));
    if (query != absl::string_view::npos) absl::StrAppend(&shown, url.substr(query, 1), "...");
  }
  absl::StrAppend(&shown, text);
  return shown;
}

std::string WithoutQuery(absl::string_view text) {
  const bool is_url = IsRemote(text) && !absl::StartsWithIgnoreCase(text, kSchemes[0]);
  return std::string(text.substr(0, is_url ? text.find_first_of("?#") : absl::string_view::npos));
}

std::string FileNameOf(const RemoteName& remote) {
  const absl::string_view last = absl::string_view(remote.name).substr(remote.name.rfind('/') + 1);
  std::string name;
  for (size_t n = 0; n < last.size(); ++n) {
    unsigned char byte = 0;
    const absl::string_view digits = last.substr(n + 1, 2);
    const bool escaped = !remote.is_s3() && last[n] == '%' && digits.size() == 2 &&
                         std::from_chars(digits.data(), digits.data() + 2, byte, 16).ptr == digits.data() + 2;
    name += escaped && byte != 0 && byte != '/' ? static_cast<char>(byte) : last[n];
    if (escaped && byte != 0 && byte != '/') n += 2;
  }
  // A file's name has at most 255 bytes. Its end has the extension.
  constexpr size_t kMost = 200;
  if (name.size() > kMost) name.erase(0, name.size() - kMost);
  return name == "." || name == ".." ? "_" : name;
}

std::string Escape(absl::string_view text, bool keep_slash) {
  std::string escaped;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool plain = absl::ascii_isalnum(byte) || absl::StrContains("-._~", c) || (keep_slash && c == '/');
    if (plain) {
      escaped += c;
    } else {
      absl::StrAppendFormat(&escaped, "%%%02X", byte);
    }
  }
  return escaped;
}

}  // namespace latvox::client
