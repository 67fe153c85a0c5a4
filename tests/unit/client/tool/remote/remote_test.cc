// Names of remote objects, and the settings of S3.
#include <gmock/gmock.h>

#include <map>
#include <string>

#include "client/tool/remote/aws_settings.h"
#include "client/tool/remote/checksum.h"
#include "client/tool/remote/http_call.h"
#include "client/tool/remote/remote_name.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

RemoteName Parsed(const std::string& text) {
  const auto remote = ParseRemote(text);
  EXPECT_TRUE(remote.ok()) << remote.status();
  return remote.value_or(RemoteName{});
}

std::string Refusal(const std::string& text) {
  const auto remote = ParseRemote(text);
  return remote.ok() ? "accepted" : std::string(remote.status().message());
}

TEST(RemoteNames, HaveThreeSchemes) {
  for (const char* const text : {"s3://b/k", "S3://b/k", "https://h/k", "HTTPS://h/k", "http://h/k"}) {
    EXPECT_TRUE(IsRemote(text)) << text;
  }
  for (const char* const text : {"", "a.obj", "s3:/b/k", "file:///a", "gs://b/k", "a/https://h/k"}) {
    EXPECT_FALSE(IsRemote(text)) << text;
  }
}

TEST(RemoteNames, KeysAreTakenAsTheyAre) {
  const RemoteName remote = Parsed("s3://my.bucket/a b/%41?x=#1+ü.obj");
  EXPECT_TRUE(remote.is_s3());
  EXPECT_EQ(remote.bucket, "my.bucket");
  EXPECT_EQ(remote.key, "a b/%41?x=#1+ü.obj");
  EXPECT_EQ(remote.name, "s3://my.bucket/a b/%41?x=#1+ü.obj");
  EXPECT_EQ(FileNameOf(remote), "%41?x=#1+ü.obj");
}

TEST(RemoteNames, OfUrlsHaveNoQuery) {
  const RemoteName remote = Parsed("https://host:8443/a/b%20c.obj?X-Amz-Signature=secret&b=c#fragment");
  EXPECT_FALSE(remote.is_s3());
  EXPECT_EQ(remote.name, "https://host:8443/a/b%20c.obj");
  EXPECT_EQ(remote.url, "https://host:8443/a/b%20c.obj?X-Amz-Signature=secret&b=c");
  EXPECT_EQ(FileNameOf(remote), "b c.obj");
}

TEST(RemoteNames, FileNamesStayInTheirFolder) {
  EXPECT_EQ(FileNameOf(Parsed("https://h/a%2Fb.obj")), "a%2Fb.obj");
  EXPECT_EQ(FileNameOf(Parsed("https://h/%00.obj")), "%00.obj");
  EXPECT_EQ(FileNameOf(Parsed("https://h/%2e%2E")), "_");
  const std::string long_name = FileNameOf(Parsed("s3://b/" + std::string(1000, 'a') + ".obj"));
  EXPECT_LE(long_name.size(), 255u);
  EXPECT_TRUE(long_name.ends_with("a.obj"));
}

TEST(RemoteNames, ErrorsTellWhyAndNoSecret) {
  EXPECT_THAT(Refusal("s3://"), HasSubstr("is not s3://BUCKET/KEY"));
  EXPECT_THAT(Refusal("s3://b c/k"), HasSubstr("a bucket has letters"));
  EXPECT_THAT(Refusal("s3://b"), HasSubstr("no file name"));
  EXPECT_THAT(Refusal("s3://b/k/"), HasSubstr("no file name"));
  EXPECT_THAT(Refusal("s3://b/a\nb"), HasSubstr("control character"));
  EXPECT_THAT(Refusal("s3://b/a/../k"), HasSubstr("a key with the part \"..\""));
  EXPECT_THAT(Refusal("s3://b/./k"), HasSubstr("a key with the part \".\""));
  EXPECT_TRUE(Parsed("s3://b/.../..k//.k").is_s3());
  EXPECT_THAT(Refusal("https:///k"), HasSubstr("has no host"));
  EXPECT_THAT(Refusal("https://h"), HasSubstr("no file name"));
  EXPECT_THAT(Refusal("https://h/a/?sig=secret"), AllOf(HasSubstr("no file name"), Not(HasSubstr("secret"))));
  EXPECT_THAT(Refusal("https://h/a b?sig=secret"), HasSubstr("as %XX"));
  EXPECT_THAT(Refusal("https://me:secret@h/k"), AllOf(HasSubstr("user or password"), Not(HasSubstr("secret"))));
}

TEST(Redaction, RemovesUsersQueriesAndFragments) {
  EXPECT_EQ(Redact("no URL? none"), "no URL? none");
  EXPECT_EQ(Redact("at https://u:p@h/a?b=c&d, and s3://x/y?z \"http://h#f\" end"),
            "at https://...@h/a?... and s3://x/y?... \"http://h#...\" end");
  EXPECT_EQ(WithoutQuery("https://h/a.csv?b"), "https://h/a.csv");
  EXPECT_EQ(WithoutQuery("s3://h/a?b.csv"), "s3://h/a?b.csv");
  EXPECT_EQ(WithoutQuery("what?.csv"), "what?.csv");
}

TEST(Escapes, KeepOnlyUnreservedBytes) {
  EXPECT_EQ(Escape("aZ09-._~/ +ü", true), "aZ09-._~/%20%2B%C3%BC");
  EXPECT_EQ(Escape("a/b", false), "a%2Fb");
}

// Reads settings from a map in place of the environment.
class Settings : public FilesTest {
 protected:
  Environment environment() const {
    return [this](const char* name) {
      const auto found = environment_.find(name);
      return found == environment_.end() ? "" : found->second;
    };
  }

  absl::StatusOr<AwsSettings> Read() const { return ReadAwsSettings(environment()); }

  std::string Refusal() const {
    const auto settings = Read();
    return settings.ok() ? "accepted" : std::string(settings.status().message());
  }

  void UseFiles(const std::string& credentials, const std::string& config) {
    environment_["AWS_SHARED_CREDENTIALS_FILE"] = Write("credentials", credentials);
    environment_["AWS_CONFIG_FILE"] = Write("config", config);
  }

  std::map<std::string, std::string> environment_;
};

TEST_F(Settings, OfTheEnvironmentComeFirst) {
  UseFiles("[default]\naws_access_key_id = file\naws_secret_access_key = file\n", "[default]\nregion = file\n");
  environment_["AWS_ACCESS_KEY_ID"] = "id";
  environment_["AWS_SECRET_ACCESS_KEY"] = "secret";
  environment_["AWS_SESSION_TOKEN"] = "token";
  environment_["AWS_DEFAULT_REGION"] = "second";
  environment_["AWS_REGION"] = "first";
  environment_["AWS_ENDPOINT_URL"] = "http://second";
  environment_["AWS_ENDPOINT_URL_S3"] = "http://first/";
  const auto settings = Read();
  ASSERT_TRUE(settings.ok()) << settings.status();
  EXPECT_EQ(settings->key_id, "id");
  EXPECT_EQ(settings->secret, "secret");
  EXPECT_EQ(settings->session_token, "token");
  EXPECT_EQ(settings->region, "first");
  EXPECT_EQ(settings->endpoint, "http://first");
}

TEST_F(Settings, OfProfilesAreInTwoFiles) {
  UseFiles(
      "# comment\n[default]\naws_access_key_id=a\naws_secret_access_key=b\n[ other ]\r\nAWS_ACCESS_KEY_ID = c=d\r\n"
      "aws_secret_access_key = e/+ \naws_session_token = t\n",
      "[profile other]\nregion = eu-1\nendpoint_url = https://store\ns3 =\n  region = nested\n[other]\nregion = no\n");
  environment_["AWS_PROFILE"] = "other";
  auto settings = Read();
  ASSERT_TRUE(settings.ok()) << settings.status();
  EXPECT_EQ(settings->key_id, "c=d");
  EXPECT_EQ(settings->secret, "e/+");
  EXPECT_EQ(settings->session_token, "t");
  EXPECT_EQ(settings->region, "eu-1");
  EXPECT_EQ(settings->endpoint, "https://store");
  environment_.erase("AWS_PROFILE");
  settings = Read();
  ASSERT_TRUE(settings.ok()) << settings.status();
  EXPECT_EQ(settings->key_id, "a");
  EXPECT_EQ(settings->session_token, "");
  EXPECT_EQ(settings->region, "us-east-1");
  EXPECT_EQ(settings->endpoint, "");
}

TEST_F(Settings, ErrorsNamePlacesAndNoSecret) {
  UseFiles("[default]\naws_access_key_id = visible\n", "");
  EXPECT_THAT(Refusal(),
              AllOf(HasSubstr("profile default has none"), HasSubstr("credentials"), Not(HasSubstr("visible"))));
  environment_["AWS_PROFILE"] = "lost";
  EXPECT_THAT(Refusal(), HasSubstr("AWS_PROFILE: \"lost\" is neither in"));
  environment_["AWS_ACCESS_KEY_ID"] = "visible";
  EXPECT_THAT(Refusal(), AllOf(HasSubstr("AWS_SECRET_ACCESS_KEY: is not set"), Not(HasSubstr("visible"))));
  environment_ = {{"AWS_SECRET_ACCESS_KEY", "visible"}};
  EXPECT_THAT(Refusal(), AllOf(HasSubstr("AWS_ACCESS_KEY_ID: is not set"), Not(HasSubstr("visible"))));
}

TEST_F(Settings, OfTriesAreWholeNumbers) {
  const auto tries = [this](const std::string& value) {
    environment_["AWS_MAX_ATTEMPTS"] = value;
    return ReadTries(environment());
  };
  EXPECT_EQ(*tries(""), kStandardTries);
  EXPECT_EQ(*tries("1"), 1);
  EXPECT_EQ(*tries("100"), 100);
  for (const char* const wrong : {"0", "101", "-1", "3.5", "x"}) {
    EXPECT_THAT(tries(wrong).status().message(), HasSubstr("AWS_MAX_ATTEMPTS")) << wrong;
  }
}

TEST(PlainHttp, IsForThisMachineUnlessAllowed) {
  const auto check = [](const std::string& url, bool allow) {
    return CheckScheme({.name = "n", .verb = "read", .url = url}, {.allow_http = allow}).ok();
  };
  for (const char* const url :
       {"http://127.0.0.1:80/a", "http://localhost/a", "http://[::1]:8/a", "HTTP://127.9.9.9/a"}) {
    EXPECT_TRUE(check(url, false)) << url;
  }
  for (const char* const url : {"http://128.0.0.1/a", "http://127.0.0.1.example/a", "http://localhost.example/a",
                                "http://[::2]/a", "http://127.x/a"}) {
    EXPECT_FALSE(check(url, false)) << url;
    EXPECT_TRUE(check(url, true)) << url;
  }
  EXPECT_TRUE(check("https://example.com/a", false));
}

TEST(Checksums, AreThoseOfTheStandards) {
  const Checksums sums = ChecksumsOf("abc");
  EXPECT_EQ(sums.md5, "\x90\x01\x50\x98\x3c\xd2\x4f\xb0\xd6\x96\x3f\x7d\x28\xe1\x7f\x72");
  EXPECT_EQ(sums.sha256.size(), 32u);
  EXPECT_EQ(sums.sha256.substr(0, 4), "\xba\x78\x16\xbf");
}

}  // namespace
}  // namespace latvox::client
