#include "server/access/authenticator.h"

#include <iterator>
#include <optional>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "server/base/errors.h"
#include "server/base/log.h"
#include "server/base/small_file.h"

namespace latvox {
namespace {

// Returns an empty text unless there is exactly one token, of this kind.
absl::string_view BearerToken(const grpc::CallbackServerContext& context) {
  constexpr absl::string_view kScheme = "bearer ";
  const auto [begin, end] = context.client_metadata().equal_range("authorization");
  if (begin == end || std::next(begin) != end) return {};
  const absl::string_view value(begin->second.data(), begin->second.size());
  return absl::StartsWithIgnoreCase(value, kScheme) ? value.substr(kScheme.size()) : absl::string_view{};
}

// Returns the name in the client's certificate, if the server asked for one.
std::string CertificateName(const grpc::CallbackServerContext& context) {
  const auto auth = context.auth_context();
  if (!auth || !auth->IsPeerAuthenticated()) return "";
  const auto names = auth->GetPeerIdentity();
  return names.empty() ? "" : std::string(names[0].data(), names[0].size());
}

}  // namespace

absl::Status Authenticator::Read() {
  if (token_file_.empty()) return absl::OkStatus();
  const auto file = ReadSmallFile(token_file_);
  if (!file.ok()) return file.status();
  auto tokens = TokenSet::Parse(file->text);
  if (!tokens.ok()) return absl::InvalidArgumentError(absl::StrCat(token_file_, ": ", tokens.status().message()));
  if (file->readable_by_all && tokens->has_plain_tokens()) {
    Log(LogLevel::kWarning, "token_file_readable_by_all", {{"path", token_file_}});
  }
  const std::lock_guard lock(mu_);
  tokens_ = std::make_shared<const TokenSet>(*std::move(tokens));
  return absl::OkStatus();
}

void Authenticator::Reload() {
  if (token_file_.empty()) return;
  if (const absl::Status status = Read(); !status.ok()) {
    Log(LogLevel::kError, "tokens_kept", {{"error", status.message()}});
    return;
  }
  Log(LogLevel::kInfo, "tokens_read", {{"path", token_file_}, {"tokens", tokens()->size()}});
}

std::shared_ptr<const TokenSet> Authenticator::tokens() const {
  const std::lock_guard lock(mu_);
  return tokens_;
}

absl::StatusOr<Caller> Authenticator::Authenticate(const grpc::CallbackServerContext& context) const {
  if (!token_file_.empty()) {
    const auto tokens = this->tokens();
    auto caller = tokens ? tokens->Find(BearerToken(context)) : std::nullopt;
    if (caller) return *std::move(caller);
    return MakeError(absl::StatusCode::kUnauthenticated,
                     "the call needs a good bearer token in the metadata \"authorization\"",
                     {"UNAUTHENTICATED", "authorization", "", ""});
  }
  Caller caller;
  caller.name = CertificateName(context);
  caller.client = caller.name.empty() ? HostOf(context.peer()) : caller.name;
  return caller;
}

}  // namespace latvox
