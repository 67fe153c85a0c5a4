#include "client/internal/channel_security.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>
#include <tuple>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "client/internal/address.h"
#include "client/internal/file_error.h"
#include "client/internal/trace_context.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

bool WantsTls(const Credentials& credentials) {
  return credentials.tls || !credentials.tls_ca_file.empty() || !credentials.tls_cert_file.empty() ||
         !credentials.tls_key_file.empty();
}

// gRPC says only much later, and in other words, that it found nothing of its `kind` in a file.
absl::StatusOr<std::string> ReadPem(const char* field, const std::string& path, absl::string_view kind) {
  const std::string limit = absl::StrCat("a file with a ", kind, " in PEM form");
  const auto wrong = [&](absl::string_view what) {
    return WithFile(absl::InvalidArgumentError(absl::StrCat(path, ": ", what)), field, path, limit);
  };
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  // An empty file sets failbit of `text` only; a directory only sets errno.
  if (!file || errno != 0) return wrong(absl::StrCat("cannot be read (", std::strerror(errno), ")"));
  if (!absl::StrContains(text.str(), "-----BEGIN ") || !absl::StrContains(text.str(), absl::StrCat(kind, "-----"))) {
    return wrong(absl::StrCat("has no ", kind, " in PEM form"));
  }
  return text.str();
}

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> MakeTlsCredentials(const Credentials& credentials) {
  if (credentials.tls_cert_file.empty() != credentials.tls_key_file.empty()) {
    const bool only_key = credentials.tls_cert_file.empty();
    absl::Status error =
        absl::InvalidArgumentError("a client's certificate and its key go together; one of them is missing");
    SetErrorDetails({"BAD_SPEC", only_key ? "tls_key_file" : "tls_cert_file",
                     only_key ? credentials.tls_key_file : credentials.tls_cert_file, "", std::nullopt},
                    error);
    return error;
  }
  grpc::SslCredentialsOptions options;
  for (const auto& [field, path, kind, text] :
       {std::tuple("tls_ca_file", &credentials.tls_ca_file, "CERTIFICATE", &options.pem_root_certs),
        std::tuple("tls_cert_file", &credentials.tls_cert_file, "CERTIFICATE", &options.pem_cert_chain),
        std::tuple("tls_key_file", &credentials.tls_key_file, "PRIVATE KEY", &options.pem_private_key)}) {
    if (path->empty()) continue;
    auto read = ReadPem(field, *path, kind);
    if (!read.ok()) return read.status();
    *text = *std::move(read);
  }
  return grpc::SslCredentials(options);
}

// RFC 6750, section 2.1. Other characters are not possible in the metadata.
bool IsToken(absl::string_view token) {
  static constexpr absl::string_view kOthers = "-._~+/=";
  return std::all_of(token.begin(), token.end(), [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || absl::StrContains(kOthers, c);
  });
}

}  // namespace

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> MakeChannelCredentials(const std::string& address,
                                                                                 const Credentials& credentials) {
  if (!IsToken(credentials.token)) {
    absl::Status error = absl::InvalidArgumentError("the token has other characters than A-Z a-z 0-9 - . _ ~ + / =");
    // The error is for logs as well, so it does not show the token.
    SetErrorDetails({"BAD_SPEC", "token", "", "A-Z a-z 0-9 - . _ ~ + / =", std::nullopt}, error);
    return error;
  }
  if (WantsTls(credentials)) {
    if (!IsUnixSocket(address)) return MakeTlsCredentials(credentials);
    return absl::InvalidArgumentError(absl::StrCat("there is no TLS on a Unix socket, which ", address, " is"));
  }
  if (!credentials.token.empty() && !IsLocalAddress(address)) {
    return absl::InvalidArgumentError(
        absl::StrCat("the token is not sent in plain text to ", address, ", which may be another machine: use TLS"));
  }
  return grpc::InsecureChannelCredentials();
}

void AddCallMetadata(const Credentials& credentials, const CallOptions& options, grpc::ClientContext& context) {
  if (!credentials.token.empty()) context.AddMetadata("authorization", absl::StrCat("Bearer ", credentials.token));
  if (!IsTraceparent(options.traceparent)) return;
  context.AddMetadata("traceparent", options.traceparent);
  if (IsTracestate(options.tracestate)) context.AddMetadata("tracestate", options.tracestate);
}

}  // namespace latvox::client
