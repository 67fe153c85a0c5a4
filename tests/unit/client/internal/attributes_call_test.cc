// Attributes, against servers with arbitrary answers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <span>

#include "tests/unit/client/fake_server.h"

namespace latvox::client {
namespace {

using testing::HasSubstr;

const std::vector<Attribute> kAsked{Attribute::kColor, Attribute::kPart};

void SetAttributes(const std::vector<uint32_t>& numbers, v1::BrickBatch& batch) {
  batch.set_attributes(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(uint32_t));
}

const std::vector<uint32_t> kFirst{0xFFFFFF, 0x7FFFFFFF}, kSecond{1, 2, 3, 4, 5, 6, 7, 8, 9, 10};

std::string DigestOfSecond() {
  Digest digest;
  digest.Add(Brick{{0, 0, 0}, {0xF0}}, std::span(kSecond).first(8));
  digest.Add(Brick{{0, 7, 1}, {2}}, std::span(kSecond).last(2));
  return digest.ToHex();
}

// Returns answers with two numbers for each of the six voxels.
Answers AttributeAnswers() {
  Answers answers(kMesh.size());
  SetAttributes(kFirst, *answers.first.mutable_bricks());
  SetAttributes(kSecond, *answers.second.mutable_bricks());
  Digest digest;
  digest.Add(Brick{{-1, 0, 0}, {1}}, std::span(kFirst));
  digest.Add(Brick{{0, 0, 0}, {0xF0}}, std::span(kSecond).first(8));
  digest.Add(Brick{{0, 7, 1}, {2}}, std::span(kSecond).last(2));
  v1::AttributeCertificate& carried = *answers.summary.mutable_summary()->mutable_certificate()->mutable_attributes();
  carried.add_attributes(v1::ATTRIBUTE_COLOR);
  carried.add_attributes(v1::ATTRIBUTE_PART);
  carried.set_digest(digest.ToHex());
  return answers;
}

absl::StatusOr<Voxelization> CallForAttributes(const std::vector<Attribute>& asked, const Answers& answers) {
  VoxelizeRequest request;
  request.attributes = asked;
  return Fake(Send(answers.All())).client().VoxelizeAll(request, kMesh);
}

TEST(AttributesCall, PassesOnTheAttributesOfAllVoxelsInTheirOrder) {
  const auto all = CallForAttributes(kAsked, AttributeAnswers());
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_THAT(all->attributes, testing::ElementsAre(0xFFFFFF, 0x7FFFFFFF, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10));
  EXPECT_EQ(all->summary.certificate.attributes->attributes, kAsked);
}

TEST(AttributesCall, EveryWrongNumberIsDataLossThatNamesIt) {
  const auto breach = [](const std::function<void(Answers&)>& commit, const std::vector<Attribute>& asked,
                         const char* says) {
    Answers answers = AttributeAnswers();
    commit(answers);
    const absl::Status status = CallForAttributes(asked, answers).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(says));
  };
  const auto send = [](const std::vector<uint32_t>& numbers) {
    return [numbers](Answers& a) { SetAttributes(numbers, *a.second.mutable_bricks()); };
  };
  const auto certify = [](const std::function<void(v1::Certificate&)>& change) {
    return [change](Answers& a) { change(*a.summary.mutable_summary()->mutable_certificate()); };
  };
  breach(send({1, 2, 3, 4, 5, 6, 7, 8}), kAsked, "attributes has 32 bytes for 2 each of 5 voxels, not 40");
  breach(send({}), kAsked, "attributes has 0 bytes");
  breach([](Answers& a) { a.second.mutable_bricks()->mutable_attributes()->pop_back(); }, kAsked, "39 bytes");
  breach(send({0x1000000, 2, 3, 4, 5, 6, 7, 8, 9, 10}), kAsked, "an attribute of 16777216, more than 16777215");
  breach(send({1, 0x80000000, 3, 4, 5, 6, 7, 8, 9, 10}), kAsked, "an attribute of 2147483648, more than 2147483647");
  breach(send({2, 1, 3, 4, 5, 6, 7, 8, 9, 10}), kAsked, "attributes' digest");
  breach(certify([](v1::Certificate& c) { c.clear_attributes(); }), kAsked, "other attributes than were asked for");
  breach(certify([](v1::Certificate& c) { c.mutable_attributes()->set_attributes(0, v1::ATTRIBUTE_MATERIAL); }), kAsked,
         "other attributes than were asked for");
  breach([](Answers&) {}, {}, "attributes has 8 bytes for 0 each of 1 voxels, not 0");
}

// The first stream breaks after its first tile. The second one brings the rest, and a digest of the rest alone.
TEST(AttributesCall, AResumedStreamsDigestIsThatOfAll) {
  const Answers answers = AttributeAnswers();
  std::atomic<int> calls = 0;
  const Fake fake([&](grpc::ServerContext*, Stream* stream) {
    v1::VoxelizeRequest request;
    stream->Read(&request);
    EXPECT_THAT(request.spec().attributes(), testing::ElementsAre(v1::ATTRIBUTE_COLOR, v1::ATTRIBUTE_PART));
    while (stream->Read(&request)) continue;
    stream->Write(answers.accepted);
    if (calls++ == 0) {
      stream->Write(answers.first);
      return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone");
    }
    Digest digest;
    digest.Add(Brick{{0, 0, 0}, {0xF0}});
    digest.Add(Brick{{0, 7, 1}, {2}});
    v1::VoxelizeResponse end = answers.summary;
    end.mutable_summary()->set_voxels(5);
    end.mutable_summary()->set_bricks(2);
    end.mutable_summary()->set_tiles(1);
    end.mutable_summary()->mutable_certificate()->set_digest(digest.ToHex());
    end.mutable_summary()->mutable_certificate()->mutable_attributes()->set_digest(DigestOfSecond());
    stream->Write(answers.second);
    stream->Write(end);
    return grpc::Status::OK;
  });
  VoxelizeRequest request;
  request.attributes = kAsked;
  const auto all = fake.client().VoxelizeAll(request, kMesh);
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(all->attributes.size(), 12U);
  EXPECT_EQ(all->summary.certificate.attributes->digest, answers.summary.summary().certificate().attributes().digest());
}

}  // namespace
}  // namespace latvox::client
