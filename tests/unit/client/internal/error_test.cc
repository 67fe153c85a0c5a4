// Errors: their details, and how they print.
#include "latvox/error.h"

#include <gmock/gmock.h>

#include <string>

#include "client/internal/printable.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "latvox/client.h"

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
