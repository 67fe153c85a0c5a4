// Errors: their details, and how they print.
#include "latvox/error.h"

#include <gmock/gmock.h>

#include <fstream>
#include <string>

#include "client/internal/grpc_message.h"
#include "client/internal/printable.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "latvox/client.h"
#include "tests/unit/temporary_directory.h"

namespace latvox::client {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Printable, EscapesControlCharactersAndWhatIsNotUtf8) {
  const std::string fine = "a\"'\\ \xC3\xA4 \xE2\x82\xAC \xF0\x9F\x98\x80";  // ASCII, two, three and four bytes
  EXPECT_EQ(Printable(fine), fine);
  EXPECT_EQ(Printable(absl::string_view("\0\x1b\n\x7f", 4)), "\\x00\\x1b\\n\\x7f");
  for (const std::string wrong : {"\x80", "\xC0\x80", "\xC2\x9B", "\xC3", "\xC3(", "\xE0\x80\x80", "\xED\xA0\x80",
                                  "\xE2\x82", "\xF0\x80\x80\x80", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF"}) {
    EXPECT_THAT(Printable(wrong), HasSubstr("\\x")) << wrong.size();
    EXPECT_THAT(Printable(wrong), Not(HasSubstr(wrong.substr(0, 1)))) << wrong.size();
  }
}

TEST(ErrorDetails, AreReadAsTheyWereSetAndReplaceOldOnes) {
  absl::Status status = absl::InvalidArgumentError("m");
  const std::string binary("\0\xff\n'", 4);
  SetErrorDetails({"R", "f", binary, "l", absl::Nanoseconds(1500000001), "o"}, status);
  ErrorDetails details = GetErrorDetails(status);
  EXPECT_EQ(details.reason, "R");
  EXPECT_EQ(details.field, "f");
  EXPECT_EQ(details.value, binary);
  EXPECT_EQ(details.limit, "l");
  EXPECT_EQ(details.other, "o");
  EXPECT_EQ(details.retry_after, absl::Nanoseconds(1500000001));
  EXPECT_EQ(Printable(status.ToString()), status.ToString());
  SetErrorDetails({"S", "", "", "", std::nullopt}, status);
  details = GetErrorDetails(status);
  EXPECT_EQ(details.reason, "S");
  EXPECT_EQ(details.field + details.value + details.limit + details.other, "");
  EXPECT_EQ(details.retry_after, std::nullopt);
  EXPECT_EQ(status.ToString(), "INVALID_ARGUMENT: m [latvox.reason='S']");
}

TEST(ErrorDetails, OfOkAreNotKept) {
  absl::Status status;
  SetErrorDetails({"R", "f", "v", "l", std::nullopt}, status);
  EXPECT_EQ(GetErrorDetails(status).reason, "");
}

TEST(GrpcMessage, IsNeverEmptyAndLacksTheCodesOfGrpc) {
  EXPECT_THAT(MessageOf({grpc::StatusCode::UNIMPLEMENTED, ""}), HasSubstr("does not offer this call (UNIMPLEMENTED)"));
  EXPECT_EQ(MessageOf({grpc::StatusCode::INTERNAL, ""}), "the server gave no reason (INTERNAL)");
  EXPECT_EQ(MessageOf({grpc::StatusCode::INTERNAL, "UNKNOWN: a\n"}), "UNKNOWN: a\\n");
  const std::string refused = "UNKNOWN: ipv4:127.0.0.1:1: Failed to connect to remote host: Connection refused";
  EXPECT_EQ(ConnectionReason(refused), "ipv4:127.0.0.1:1: Connection refused");
  EXPECT_EQ(ConnectionReason("UNAVAILABLE: a\nb"), "a b");
  EXPECT_EQ(ConnectionReason("DNS resolution failed for a:1: C-ares status is not ARES_SUCCESS: Domain name not found"),
            "Domain name not found");
  EXPECT_EQ(MessageOf({grpc::StatusCode::UNAVAILABLE, "connections to all backends failing; last error: " + refused}),
            "no server can be reached (ipv4:127.0.0.1:1: Connection refused)");
}

TEST(Connect, NamesAFileWithoutTheCertificateOrKeyThatItIsFor) {
  const TemporaryDirectory directory;
  std::ofstream(directory / "key.pem") << "-----BEGIN PRIVATE KEY-----\n-----END PRIVATE KEY-----\n";
  std::ofstream(directory / "roots.pem") << "-----BEGIN CERTIFICATE-----\n-----END CERTIFICATE-----\n";
  std::ofstream(directory / "text.pem") << "CERTIFICATE-----\n";
  const auto expect = [&directory](const char* roots, const char* certificate, const char* key, const char* field,
                                   const std::string& file, const std::string& says) {
    ConnectionOptions options;
    options.credentials.tls_ca_file = directory / roots;
    options.credentials.tls_cert_file = directory / certificate;
    if (*key != 0) options.credentials.tls_key_file = directory / key;
    const absl::Status status = Client::Connect("127.0.0.1:1", {}, options).status();
    const ErrorDetails details = GetErrorDetails(status);
    EXPECT_THAT(std::string(status.message()), HasSubstr(says));
    EXPECT_EQ(details.field, field);
    EXPECT_EQ(details.value, directory / file);
    EXPECT_EQ(details.reason, "BAD_SPEC");
    EXPECT_EQ(details.limit.empty(), *key == 0);
  };
  expect("key.pem", "roots.pem", "key.pem", "tls_ca_file", "key.pem", "key.pem: has no CERTIFICATE in PEM form");
  expect("text.pem", "roots.pem", "key.pem", "tls_ca_file", "text.pem", "text.pem: has no CERTIFICATE");
  expect("roots.pem", "roots.pem", "roots.pem", "tls_key_file", "roots.pem", "roots.pem: has no PRIVATE KEY");
  expect("roots.pem", "none.pem", "key.pem", "tls_cert_file", "none.pem", "none.pem: cannot be read (No such file");
  expect("roots.pem", "roots.pem", "", "tls_cert_file", "roots.pem", "go together");
}

TEST(Connect, RefusesInPrintableWords) {
  for (const std::string address : {"\x1b[2J", "unix:\x01\xff", "\xff:1"}) {
    CallOptions options;
    options.deadline = absl::Now() + absl::Seconds(5);
    const absl::Status status = Client::Connect(address, options).status();
    EXPECT_FALSE(status.ok());
    EXPECT_EQ(status.ToString(), Printable(status.ToString()));
  }
  const absl::Status status = Client::StartPrivate({.program = "/\x1b/latvoxd"}).status();
  EXPECT_THAT(std::string(status.message()), HasSubstr("/\\x1b/latvoxd"));
}

}  // namespace
}  // namespace latvox::client
