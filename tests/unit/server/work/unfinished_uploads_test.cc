// Meshes that arrive in pieces over many calls: what is kept, for how long, and whose room it is.
#include "server/work/unfinished_uploads.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;
using ::testing::HasSubstr;

constexpr uint64_t kRoom = 1000;

class UnfinishedUploadsTest : public testing::Test {
 protected:
  static MeshSpec Mesh(uint8_t name, uint64_t bytes) { return {.digest = {name}, .bytes = bytes}; }

  absl::StatusOr<UnfinishedUploads::Progress> Add(const std::string& client, const MeshSpec& mesh, uint64_t offset,
                                                  std::string piece) {
    return uploads_.Add(client, mesh, offset, std::move(piece), now_);
  }
  // Returns the next offset of a piece that is taken.
  uint64_t Next(const std::string& client, const MeshSpec& mesh, uint64_t offset, std::string piece) {
    const auto progress = Add(client, mesh, offset, std::move(piece));
    EXPECT_TRUE(progress.ok()) << progress.status();
    return progress.ok() ? progress->next_offset : 0;
  }
  std::string Refusal(const std::string& client, const MeshSpec& mesh, uint64_t bytes) {
    const absl::Status status = Add(client, mesh, 0, std::string(bytes, 'x')).status();
    EXPECT_EQ(ReasonOf(status), "TOO_MANY_UPLOADS");
    EXPECT_TRUE(RetryDelayOf(status));
    return std::string{status.message()};
  }

  MemoryBudget memory_{10 * kRoom};
  UnfinishedUploads uploads_{memory_, kRoom};
  UnfinishedUploads::Clock::time_point now_ = UnfinishedUploads::Clock::now();
};

TEST_F(UnfinishedUploadsTest, GoOnByOffsetAndMayRepeatBytes) {
  const MeshSpec mesh = Mesh(1, 9);
  EXPECT_EQ(Next("a", mesh, 0, ""), 0);
  EXPECT_EQ(uploads_.size(), 0) << "a question keeps nothing";
  EXPECT_EQ(Next("a", mesh, 0, "abcd"), 4);
  EXPECT_EQ(Next("a", mesh, 0, "abcd"), 4);
  EXPECT_EQ(Next("a", mesh, 2, "cdef"), 6);
  EXPECT_EQ(Next("a", mesh, 99, ""), 6);
  EXPECT_EQ(memory_.reserved(), 6);
  const auto last = Add("a", mesh, 6, "ghi");
  ASSERT_TRUE(last.ok() && last->complete);
  EXPECT_EQ(last->complete->bytes, "abcdefghi");
  const auto again = Add("a", mesh, 0, "");
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->complete, last->complete) << "the call that had it may have ended early";
}

TEST_F(UnfinishedUploadsTest, AGapIsRefusedAndChangesNothing) {
  const MeshSpec mesh = Mesh(1, 9);
  EXPECT_EQ(Next("a", mesh, 0, "abc"), 3);
  const absl::Status gap = Add("a", mesh, 4, "e").status();
  EXPECT_EQ(gap.message(), "offset 4 is beyond the 3 bytes that the server has");
  EXPECT_EQ(*CauseOf(gap), (ErrorCause{"WRONG_OFFSET", "offset", "4", "3"}));
  EXPECT_EQ(Next("a", mesh, 3, "d"), 4);
}

TEST_F(UnfinishedUploadsTest, AContradictionBeginsAgain) {
  const MeshSpec mesh = Mesh(1, 4);
  for (const char* piece : {"axc", "abcde"}) {
    EXPECT_EQ(Next("a", mesh, 0, "abc"), 3);
    EXPECT_EQ(ReasonOf(Add("a", mesh, 0, piece).status()), "BAD_SPEC") << piece;
    EXPECT_EQ(Next("a", mesh, 0, ""), 0);
    EXPECT_EQ(memory_.reserved(), 0);
  }
  MeshSpec raw = Mesh(1, 24);
  raw.raw = RawMeshLayout{.vertices = 1, .triangles = 1};
  EXPECT_EQ(Next("a", raw, 0, std::string(13, '\0')), 13);
  EXPECT_EQ(Add("a", raw, 12, std::string("\0\1\0\0", 4)).status().message(), "mesh: triangle 0 uses vertex 256 of 1");
  EXPECT_EQ(Next("a", raw, 0, ""), 0);
}

TEST_F(UnfinishedUploadsTest, BelongToTheirClientAndTheirSpecification) {
  EXPECT_EQ(Next("a", Mesh(1, 9), 0, "abc"), 3);
  EXPECT_EQ(Next("b", Mesh(1, 9), 0, ""), 0);
  EXPECT_EQ(Next("a", Mesh(2, 9), 0, ""), 0);
  EXPECT_EQ(Next("a", Mesh(1, 8), 0, ""), 0);
}

TEST_F(UnfinishedUploadsTest, OfOneClientHaveHalfOfTheRoom) {
  EXPECT_EQ(Next("a", Mesh(1, kRoom), 0, std::string(900, 'x')), 900);
  EXPECT_EQ(Refusal("a", Mesh(2, kRoom), 101),
            "uploads_of_client: 1001 bytes of unfinished ones exceed 1000; try again");
  EXPECT_EQ(Next("b", Mesh(1, kRoom), 0, std::string(1000, 'x')), 1000);
  EXPECT_EQ(Next("c", Mesh(1, kRoom), 0, std::string(100, 'x')), 100);
  EXPECT_EQ(Refusal("c", Mesh(2, kRoom), 1), "uploads: 2001 bytes of unfinished ones exceed 2000; try again");
  now_ += seconds(10);
  EXPECT_EQ(Next("c", Mesh(2, kRoom), 0, "x"), 1) << "the longest idle one makes room";
  EXPECT_EQ(Next("a", Mesh(1, kRoom), 0, ""), 0);
  EXPECT_EQ(uploads_.size(), 3);
  EXPECT_EQ(uploads_.bytes(), 1101);
  EXPECT_EQ(memory_.reserved(), 1101);
}

TEST_F(UnfinishedUploadsTest, OfOneClientAreFew) {
  for (uint8_t n = 0; n < UnfinishedUploads::kMostOfClient; ++n) EXPECT_EQ(Next("a", Mesh(n, 9), 0, "x"), 1);
  EXPECT_THAT(Refusal("a", Mesh(200, 9), 1), HasSubstr("uploads_of_client: 65 unfinished ones exceed 64"));
  EXPECT_EQ(Next("a", Mesh(3, 9), 1, "x"), 2) << "begun ones go on";
  for (int client = 1; client < 16; ++client) {
    for (uint8_t n = 0; n < 64; ++n) EXPECT_EQ(Next(absl::StrCat(client), Mesh(n, 9), 0, "x"), 1);
  }
  EXPECT_EQ(Refusal("b", Mesh(1, 9), 1), "uploads: 1025 unfinished ones exceed 1024; try again");
}

TEST_F(UnfinishedUploadsTest, AgeOutWithoutProgress) {
  EXPECT_EQ(Next("a", Mesh(1, 9000), 0, "x"), 1);
  EXPECT_EQ(Next("a", Mesh(2, 9000), 0, "x"), 1);
  now_ += milliseconds(500);
  EXPECT_EQ(Next("a", Mesh(1, 9000), 1, "x"), 2) << "taken, but a trickle is no progress";
  EXPECT_EQ(Next("a", Mesh(2, 9000), 1, std::string(500, 'x')), 501);
  now_ += minutes(10) - milliseconds(500);
  uploads_.DropIdle(UnfinishedUploads::kPatience, now_);
  EXPECT_EQ(Next("a", Mesh(1, 9000), 0, ""), 0);
  EXPECT_EQ(Next("a", Mesh(2, 9000), 0, ""), 501);
  uploads_.DropIdle(UnfinishedUploads::kPatience, now_ + seconds(1));
  EXPECT_EQ(uploads_.size(), 0);
  EXPECT_EQ(memory_.reserved(), 0);
}

TEST_F(UnfinishedUploadsTest, ShareTheMemoryOfJobs) {
  MemoryReservation job(memory_, "b");
  ASSERT_TRUE(job.Grow(10 * kRoom - 5).ok());
  EXPECT_EQ(Next("a", Mesh(1, 9), 0, "abcde"), 5);
  EXPECT_EQ(ReasonOf(Add("a", Mesh(1, 9), 5, "f").status()), "MEMORY_IN_USE");
  job.Shrink(0);
  EXPECT_EQ(Next("a", Mesh(1, 9), 5, "f"), 6) << "what had come is kept";
}

}  // namespace
}  // namespace latvox
