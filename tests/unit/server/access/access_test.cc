// Access control, and the facts of a call before its first message.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/access/caller.h"
#include "server/access/token_set.h"
#include "server/access/trace_context.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string kToken = "correct-horse-battery", kOther = "staple~+/0123456==";

TEST(TokenSet, FindsEachOfItsTokensAndNothingElse) {
  const auto set = TokenSet::Parse(absl::StrCat("# clients\n\nalice ", kToken, "\r\n  bob\t", kOther, "  \n"));
  ASSERT_TRUE(set.ok()) << set.status();
  EXPECT_EQ(set->size(), 2);
  EXPECT_TRUE(set->has_plain_tokens());
  ASSERT_TRUE(set->Find(kToken));
  EXPECT_EQ(set->Find(kToken)->name, "alice");
  EXPECT_EQ(set->Find(kToken)->client, "alice");
  ASSERT_TRUE(set->Find(kOther));
  EXPECT_EQ(set->Find(kOther)->name, "bob");
  for (const std::string& wrong : {std::string(), std::string("alice"), kToken + "x", kToken.substr(1), kToken + " ",
                                   kToken + '\0', std::string(100000, 'x')}) {
    EXPECT_FALSE(set->Find(wrong)) << wrong.substr(0, 40);
  }
}

TEST(TokenSet, AHashInTheFileStandsForItsToken) {
  // printf %s correct-horse-battery | sha256sum
  const std::string hash = "62249369389075490555a758353aec61500c6218fa597252d52dc4bd0148f12d";
  for (const bool upper : {false, true}) {
    std::string digits = hash;
    if (upper) {
      for (char& c : digits) c = static_cast<char>(std::toupper(c));
    }
    const auto hashed = TokenSet::Parse("alice sha256:" + digits);
    ASSERT_TRUE(hashed.ok()) << hashed.status();
    EXPECT_FALSE(hashed->has_plain_tokens());
    EXPECT_TRUE(hashed->Find(kToken));
    EXPECT_FALSE(hashed->Find("sha256:" + digits));
    EXPECT_FALSE(hashed->Find(digits));
  }
}

TEST(TokenSet, ANameMayHaveSeveralTokensWithLimitsOfTheirOwn) {
  const auto set = TokenSet::Parse(absl::StrCat("alice ", kToken,
                                                " max-jobs=2 max-mesh-bytes=64MiB max-triangles=9 max-job-seconds=7\n",
                                                "alice ", kOther, "\n"));
  ASSERT_TRUE(set.ok()) << set.status();
  const Caller limited = *set->Find(kToken), free = *set->Find(kOther);
  EXPECT_EQ(limited.client, free.client);
  EXPECT_EQ(limited.limits.max_jobs, 2);
  EXPECT_EQ(limited.limits.max_mesh_bytes, 64 << 20);
  EXPECT_EQ(limited.limits.max_triangles, 9);
  EXPECT_EQ(limited.limits.max_job_seconds, 7);
  EXPECT_EQ(free.limits.max_jobs, 0);
}

TEST(TokenSet, RefusesAFileThatIsWrongNamingTheLineButNeverATokensText) {
  struct Case {
    std::string line, says;
  };
  for (const Case& wrong : std::vector<Case>{
           {"correct-horse-battery", "line 2: it has no token"},
           {"al:ice correct-horse-battery", "line 2: the name"},
           {"alice correct-horse", "line 2: the token has 13 characters, not 16 to 512"},
           {"alice correct-horse-b@ttery", "line 2: the token has other characters"},
           {"alice sha256:00ff", "line 2: sha256: is not followed by 64"},
           {"alice correct-horse-battery max-job=2", "line 2: behind the token stands none of"},
           {"alice staple-horse-battery correct-horse-battery", "line 2: behind the token stands none of"},
           {"alice correct-horse-battery max-job-seconds=1.5", "line 2: max-job-seconds is not a whole number above 0"},
           {"alice correct-horse-battery max-jobs=0", "line 2: max-jobs is not a whole number above 0"},
           {"alice correct-horse-battery max-jobs=-1", "line 2: max-jobs is not a whole number above 0"},
           {"alice correct-horse-battery max-jobs=4294967296", "line 2: max-jobs is above 4294967295"},
           {"alice correct-horse-battery max-jobs=1KiB", "line 2: max-jobs is not a whole number above 0"},
           {"alice correct-horse-battery max-mesh-bytes=17179869184GiB",
            "line 2: max-mesh-bytes is not a whole number above 0"},
           {"alice correct-horse-battery max-mesh-bytes=many", "line 2: max-mesh-bytes is not a whole number above 0"},
           {"alice correct-horse-battery\nbob correct-horse-battery", "line 3: the token stands on an earlier line"},
           {"# nobody", "there is no token"}}) {
    const auto set = TokenSet::Parse("# first\n" + wrong.line + "\n");
    ASSERT_FALSE(set.ok()) << wrong.line;
    EXPECT_THAT(std::string(set.status().message()), HasSubstr(wrong.says));
    EXPECT_THAT(std::string(set.status().message()), Not(HasSubstr("correct")));
  }
}

TEST(Caller, LimitsAreTheSmallerOnesOfCallerAndServer) {
  Limits server;
  server.max_triangles = 100;
  const Caller caller{
      .name = "alice", .client = "alice", .limits = {.max_jobs = 1, .max_mesh_bytes = 7, .max_triangles = 200}};
  EXPECT_EQ(LimitsOf(caller, server).max_mesh_bytes, 7);
  EXPECT_EQ(LimitsOf(caller, server).max_triangles, 100);
  EXPECT_EQ(LimitsOf(Caller(), server).max_mesh_bytes, server.max_mesh_bytes);
}

TEST(Caller, IsTheHostWithoutItsPort) {
  EXPECT_EQ(HostOf("ipv4:10.0.0.1:4711"), "10.0.0.1");
  EXPECT_EQ(HostOf("ipv6:%5B2001:db8:1:2:3:4:5:6%5D:4711"), "2001:db8:1:2::/64");
  EXPECT_EQ(HostOf("ipv6:[2001:db8:1:2:ffff::1]:4711"), "2001:db8:1:2::/64");
  EXPECT_EQ(HostOf("ipv6:%5Bfe80::1%25eth0%5D:4711"), "fe80::/64");
  EXPECT_EQ(HostOf("unix:"), "unix");
  EXPECT_EQ(HostOf("unix:/run/latvoxd"), "unix");
}

TEST(TraceContext, IsReadAsW3CSays) {
  const std::string trace = "4bf92f3577b34da6a3ce929d0e0e4736", parent = "00f067aa0ba902b7";
  const auto context = ReadTraceparent("00-" + trace + "-" + parent + "-01");
  ASSERT_TRUE(context);
  EXPECT_EQ(context->trace_id, trace);
  EXPECT_EQ(context->parent_id, parent);
  EXPECT_EQ(context->flags, "01");
  EXPECT_EQ(context->span_id.size(), 16);
  EXPECT_NE(context->span_id, parent);
  EXPECT_EQ(Traceparent(*context), "00-" + trace + "-" + context->span_id + "-01");
  EXPECT_NE(ReadTraceparent("00-" + trace + "-" + parent + "-01")->span_id, context->span_id);
  // A later version may have more behind a dash.
  EXPECT_TRUE(ReadTraceparent("cc-" + trace + "-" + parent + "-01"));
  EXPECT_TRUE(ReadTraceparent("cc-" + trace + "-" + parent + "-01-what-the-future-will-be-like"));
}

TEST(TraceContext, WhatIsMalformedIsNone) {
  const std::string trace = "4bf92f3577b34da6a3ce929d0e0e4736", parent = "00f067aa0ba902b7";
  for (const std::string& wrong : std::vector<std::string>{
           "", "00", "00-" + trace + "-" + parent, "00-" + trace + "-" + parent + "-0",
           "00-" + trace + "-" + parent + "-1x", "00-" + trace + "-" + parent + "-01-",
           "00-" + trace + "-" + parent + "-01-more", "cc-" + trace + "-" + parent + "-01.more",
           "ff-" + trace + "-" + parent + "-01", "0x-" + trace + "-" + parent + "-01",
           "00-" + std::string(32, '0') + "-" + parent + "-01", "00-" + trace + "-" + std::string(16, '0') + "-01",
           "00-4BF92F3577B34DA6A3CE929D0E0E4736-" + parent + "-01", "00_" + trace + "_" + parent + "_01"}) {
    EXPECT_FALSE(ReadTraceparent(wrong)) << wrong;
  }
}

}  // namespace
}  // namespace latvox
