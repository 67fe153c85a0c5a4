#include "server/access/tls_source.h"

#include <grpc/grpc.h>
#include <grpc/grpc_security.h>

#include <mutex>
#include <string>
#include <utility>

#include "server/base/log.h"

namespace latvox {

struct TlsSource::Current {
  mutable std::mutex mu;
  std::shared_ptr<const TlsTexts> texts;  // guarded by mu; replaced as a whole

  std::shared_ptr<const TlsTexts> Get() const {
    const std::lock_guard lock(mu);
    return texts;
  }
};

namespace {

// gRPC's FileWatcherCertificateProvider trusts the operator to change key and certificate at once, and to keep them a
// pair. gRPC's core has a fetcher instead. It runs at each new connection, so that we can check them first; only the
// wrapper is missing in C++.
template <class Current>
class ReloadingCredentials final : public grpc::ServerCredentials {
 public:
  explicit ReloadingCredentials(std::shared_ptr<const Current> current) : current_(std::move(current)) {
    const auto request = current_->Get()->client_ca.empty()
                             ? GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE
                             : GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY;
    credentials_ = grpc_ssl_server_credentials_create_with_options(
        grpc_ssl_server_credentials_create_options_using_config_fetcher(request, &Fetch, this));
  }
  ~ReloadingCredentials() override { grpc_server_credentials_release(credentials_); }

  // Authenticator checks tokens.
  void SetAuthMetadataProcessor(const std::shared_ptr<grpc::AuthMetadataProcessor>& /*processor*/) override {}

 private:
  int AddPortToServer(const std::string& address, grpc_server* server) override {
    return grpc_server_add_http2_port(server, address.c_str(), credentials_);
  }

  // Runs on gRPC's threads.
  static grpc_ssl_certificate_config_reload_status Fetch(void* self, grpc_ssl_server_certificate_config** config) {
    return static_cast<ReloadingCredentials*>(self)->FetchNew(config);
  }

  grpc_ssl_certificate_config_reload_status FetchNew(grpc_ssl_server_certificate_config** config) {
    auto texts = current_->Get();
    const std::lock_guard lock(mu_);
    if (texts == given_) return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_UNCHANGED;
    const grpc_ssl_pem_key_cert_pair pair = {texts->key.c_str(), texts->certificate.c_str()};
    // gRPC insists on roots even where no client is asked for a certificate. Then they have no effect.
    const std::string& roots = texts->client_ca.empty() ? texts->certificate : texts->client_ca;
    *config = grpc_ssl_server_certificate_config_create(roots.c_str(), &pair, 1);
    given_ = std::move(texts);
    return GRPC_SSL_CERTIFICATE_CONFIG_RELOAD_NEW;
  }

  const std::shared_ptr<const Current> current_;
  std::mutex mu_;
  std::shared_ptr<const TlsTexts> given_;  // guarded by mu_
  grpc_server_credentials* credentials_ = nullptr;
};

}  // namespace

TlsSource::TlsSource(const TlsFiles& files) : files_(files), current_(std::make_shared<Current>()) {}
TlsSource::~TlsSource() = default;

absl::Status TlsSource::Read() {
  if (files_.certificate.empty() && files_.key.empty() && files_.client_ca.empty()) return absl::OkStatus();
  auto texts = ReadTlsFiles(files_);
  if (!texts.ok()) return texts.status();
  if (texts->key_readable_by_all) Log(LogLevel::kWarning, "tls_key_readable_by_all", {{"path", files_.key}});
  if (texts->expires < absl::Now()) {
    Log(LogLevel::kWarning, "tls_certificate_expired",
        {{"path", files_.certificate}, {"since", absl::FormatTime(texts->expires, absl::UTCTimeZone())}});
  }
  const std::lock_guard lock(current_->mu);
  current_->texts = std::make_shared<const TlsTexts>(*std::move(texts));
  return absl::OkStatus();
}

void TlsSource::Reload() {
  if (!enabled()) return;
  if (const absl::Status status = Read(); !status.ok()) {
    Log(LogLevel::kError, "tls_certificate_kept", {{"error", status.message()}});
    return;
  }
  Log(LogLevel::kInfo, "tls_certificate_read",
      {{"path", files_.certificate}, {"expires", absl::FormatTime(expires(), absl::UTCTimeZone())}});
}

absl::Time TlsSource::expires() const {
  const auto texts = current_->Get();
  return texts ? texts->expires : absl::InfiniteFuture();
}

std::shared_ptr<grpc::ServerCredentials> TlsSource::Credentials() {
  return credentials_.emplace_back(std::make_shared<ReloadingCredentials<Current>>(current_));
}

}  // namespace latvox
