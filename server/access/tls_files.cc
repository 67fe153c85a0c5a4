#include "server/access/tls_files.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <ctime>
#include <memory>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/base/small_file.h"

namespace latvox {
namespace {

template <auto Free>
struct Freed {
  template <class T>
  void operator()(T* object) const {
    Free(object);
  }
};
using Bio = std::unique_ptr<BIO, Freed<BIO_free_all>>;
using Certificate = std::unique_ptr<X509, Freed<X509_free>>;
using Key = std::unique_ptr<EVP_PKEY, Freed<EVP_PKEY_free>>;

absl::Status Wrong(const std::string& path, absl::string_view why) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", why));
}

Bio Reader(const std::string& text) { return Bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size()))); }

// Without this function, OpenSSL would ask at the terminal.
int NoPassphrase(char* /*buffer*/, int /*size*/, int /*writing*/, void* /*data*/) { return -1; }

absl::StatusOr<std::vector<Certificate>> ReadCertificates(const std::string& path, const std::string& text) {
  const Bio reader = Reader(text);
  std::vector<Certificate> certificates;
  while (X509* certificate = PEM_read_bio_X509(reader.get(), nullptr, NoPassphrase, nullptr)) {
    certificates.emplace_back(certificate);
  }
  // The end of the file gives this error; any other one is a fault of the file.
  const bool at_the_end = ERR_GET_REASON(ERR_peek_last_error()) == PEM_R_NO_START_LINE;
  ERR_clear_error();
  if (certificates.empty()) return Wrong(path, "it holds no certificate in PEM form");
  if (!at_the_end) {
    return Wrong(path, absl::StrCat("certificate ", certificates.size() + 1, " of the file cannot be read"));
  }
  return certificates;
}

absl::Time ExpiryOf(const X509& certificate) {
  std::tm time{};
  if (ASN1_TIME_to_tm(X509_get0_notAfter(&certificate), &time) != 1) return absl::InfinitePast();
  return absl::FromTM(time, absl::UTCTimeZone());
}

absl::Status CheckKey(const TlsFiles& files, const std::string& text, X509& certificate) {
  const Bio reader = Reader(text);
  const Key key(PEM_read_bio_PrivateKey(reader.get(), nullptr, NoPassphrase, nullptr));
  const bool belongs = key != nullptr && X509_check_private_key(&certificate, key.get()) == 1;
  ERR_clear_error();
  if (key == nullptr) return Wrong(files.key, "it holds no private key in PEM form without a passphrase");
  if (!belongs) return Wrong(files.key, absl::StrCat("the key is not that of the certificate in ", files.certificate));
  return absl::OkStatus();
}

absl::Status CheckPaths(const TlsFiles& files) {
  if (!files.certificate.empty() && !files.key.empty()) return absl::OkStatus();
  if (!files.certificate.empty()) return absl::InvalidArgumentError("--tls-cert needs --tls-key");
  return absl::InvalidArgumentError(
      absl::StrCat(files.key.empty() ? "--tls-client-ca" : "--tls-key", " needs --tls-cert"));
}

}  // namespace

absl::StatusOr<TlsTexts> ReadTlsFiles(const TlsFiles& files) {
  if (absl::Status status = CheckPaths(files); !status.ok()) return status;
  TlsTexts texts;
  auto certificate = ReadSmallFile(files.certificate);
  if (!certificate.ok()) return certificate.status();
  const auto chain = ReadCertificates(files.certificate, certificate->text);
  if (!chain.ok()) return chain.status();
  auto key = ReadSmallFile(files.key);
  if (!key.ok()) return key.status();
  if (absl::Status status = CheckKey(files, key->text, *chain->front()); !status.ok()) return status;
  if (!files.client_ca.empty()) {
    auto client_ca = ReadSmallFile(files.client_ca);
    if (!client_ca.ok()) return client_ca.status();
    const auto roots = ReadCertificates(files.client_ca, client_ca->text);
    if (!roots.ok()) return roots.status();
    texts.client_ca = std::move(client_ca->text);
  }
  texts.expires = ExpiryOf(*chain->front());
  texts.key_readable_by_all = key->readable_by_all;
  texts.certificate = std::move(certificate->text);
  texts.key = std::move(key->text);
  return texts;
}

}  // namespace latvox
