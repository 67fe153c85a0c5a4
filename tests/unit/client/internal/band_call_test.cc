// Bands, against servers with arbitrary answers.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <span>

#include "latvox/error.h"
#include "tests/unit/client/fake_server.h"

namespace latvox::client {
namespace {

using testing::HasSubstr;

constexpr Band kSignedBand{.width = 2, .is_signed = true};

void SetValues(const std::vector<float>& values, v1::BrickBatch& batch) {
  batch.set_values(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
}

// Returns answers with a distance for each of the six voxels.
Answers BandAnswers() {
  Answers answers(kMesh.size());
  const std::vector<float> first{-2}, second{0, 1, 2, -0.5F, 1.5F};
  SetValues(first, *answers.first.mutable_bricks());
  SetValues(second, *answers.second.mutable_bricks());
  Digest digest;
  digest.Add(Brick{{-1, 0, 0}, {1}}, first);
  digest.Add(Brick{{0, 0, 0}, {0xF0}}, std::span(second).first(4));
  digest.Add(Brick{{0, 7, 1}, {2}}, std::span(second).last(1));
  v1::BandCertificate& band = *answers.summary.mutable_summary()->mutable_certificate()->mutable_band();
  band.set_width(2);
  band.set_is_signed(true);
  band.set_digest(digest.ToHex());
  return answers;
}

absl::Status CallForBand(const Band& band, const Answers& answers, std::vector<float>* values = nullptr) {
  VoxelizeRequest request;
  request.band = band;
  VoxelizeHandlers handlers;
  handlers.on_bricks = [&](const BrickBatch& batch) {
    if (values != nullptr) values->insert(values->end(), batch.values.begin(), batch.values.end());
    return absl::OkStatus();
  };
  return Fake(Send(answers.All())).client().Voxelize(request, kMesh, handlers).status();
}

TEST(BandCall, PassesOnTheDistancesOfAllVoxelsInTheirOrder) {
  std::vector<float> values;
  EXPECT_EQ(CallForBand(kSignedBand, BandAnswers(), &values), absl::OkStatus());
  EXPECT_THAT(values, testing::ElementsAre(-2, 0, 1, 2, -0.5F, 1.5F));
  // A width in voxels refers to the grid that the server reports.
  EXPECT_EQ(CallForBand({.width = 2, .in_voxels = true, .is_signed = true}, BandAnswers()), absl::OkStatus());
}

TEST(BandCall, EveryWrongValueIsDataLossThatNamesIt) {
  const auto breach = [](const std::function<void(Answers&)>& commit, const Band& band, const char* says) {
    Answers answers = BandAnswers();
    commit(answers);
    const absl::Status status = CallForBand(band, answers);
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(says));
  };
  const auto send = [](const std::vector<float>& values) {
    return [values](Answers& a) { SetValues(values, *a.second.mutable_bricks()); };
  };
  const auto certify = [](const std::function<void(v1::Certificate&)>& change) {
    return [change](Answers& a) { change(*a.summary.mutable_summary()->mutable_certificate()); };
  };
  breach(send({0, 1, 2, 0}), kSignedBand, "values has 16 bytes for 5 voxels, not 20");
  breach(send({0, 1, 2, 0, 0, 0}), kSignedBand, "values has 24 bytes for 5 voxels, not 20");
  breach([](Answers& a) { a.second.mutable_bricks()->mutable_values()->pop_back(); }, kSignedBand, "19 bytes");
  breach([](Answers& a) { a.second.mutable_bricks()->clear_values(); }, kSignedBand, "values has 0 bytes");
  breach(send({0, 1, NAN, 0, 0}), kSignedBand, "a distance of nan in a band of 2");
  breach(send({0, 1, 2.0000002F, 0, 0}), kSignedBand, "in a band of 2");
  breach(send({0, 1, -INFINITY, 0, 0}), kSignedBand, "a distance of -inf");
  breach(send({0, 1, -0.0F, 0, 0}), kSignedBand, "a distance of -0 in a signed band");
  breach(send({0, 1, 2, -0.25F, 1.5F}), kSignedBand, "band's digest");
  breach([](Answers&) {}, {.width = 2}, "a distance of -2 in a band without signs");
  breach(certify([](v1::Certificate& c) { c.clear_band(); }), kSignedBand, "a certificate without a band");
  breach(certify([](v1::Certificate& c) { c.mutable_band()->set_width(3); }), kSignedBand, "a band of 3");
  breach(certify([](v1::Certificate& c) { c.mutable_band()->set_is_signed(false); }), kSignedBand, "not signed");
}

// The first stream breaks after its first tile. The second one brings the rest, and counts and digests of the rest
// alone.
TEST(BandCall, AResumedStreamsDigestIsThatOfAllValues) {
  const Answers answers = BandAnswers();
  std::atomic<int> calls = 0;
  const Fake fake([&](grpc::ServerContext*, Stream* stream) {
    v1::VoxelizeRequest request;
    stream->Read(&request);
    EXPECT_EQ(request.spec().band().width(), 2);
    EXPECT_TRUE(request.spec().band().is_signed());
    while (stream->Read(&request)) continue;
    stream->Write(answers.accepted);
    if (calls++ == 0) {
      stream->Write(answers.first);
      return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone");
    }
    const std::vector<float> values{0, 1, 2, -0.5F, 1.5F};
    Digest digest, of_values;
    for (const auto& [brick, count] : {std::pair{Brick{{0, 0, 0}, {0xF0}}, 4}, {Brick{{0, 7, 1}, {2}}, 1}}) {
      digest.Add(brick);
      of_values.Add(brick, count == 4 ? std::span(values).first(4) : std::span(values).last(1));
    }
    v1::VoxelizeResponse end = answers.summary;
    end.mutable_summary()->set_voxels(5);
    end.mutable_summary()->set_bricks(2);
    end.mutable_summary()->set_tiles(1);
    end.mutable_summary()->mutable_certificate()->set_digest(digest.ToHex());
    end.mutable_summary()->mutable_certificate()->mutable_band()->set_digest(of_values.ToHex());
    stream->Write(answers.second);
    stream->Write(end);
    return grpc::Status::OK;
  });
  VoxelizeRequest request;
  request.band = kSignedBand;
  const auto summary = fake.client().Voxelize(request, kMesh, {});
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(summary->certificate.band->digest, answers.summary.summary().certificate().band().digest());
}

TEST(BandCall, ValuesWithoutARequestForThemAreRefused) {
  EXPECT_THAT(std::string(CallWith(BandAnswers().All()).message()),
              HasSubstr("values has 4 bytes for 1 voxels without a band"));
}

}  // namespace
}  // namespace latvox::client
