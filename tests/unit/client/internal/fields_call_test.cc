// Fields, against servers with arbitrary answers.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zstd.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "latvox/error.h"
#include "latvox/for_each_voxel.h"
#include "tests/unit/client/fake_server.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// A band with its distances, the color and the number of the nearest triangle.
VoxelizeRequest AskedFor() {
  VoxelizeRequest request;
  request.set = Band{.width = 2};
  request.fields = {Field::kDistance, Field::kColor, Field::kTriangle};
  request.signed_distance = true;
  return request;
}

// The values of one field: of the first batch's voxel, and of the five of the second batch.
struct Column {
  std::string first, second;

  // The size of a voxel's value.
  size_t bytes() const { return first.size(); }
};

template <class T>
std::string Bytes(const std::vector<T>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T)};
}

using Columns = std::vector<Column>;

Columns Good() {
  return {{Bytes<float>({-2}), Bytes<float>({0, 1, 2, -0.5F, 1.5F})},
          {Bytes<uint8_t>({255, 0, 9}), Bytes<uint8_t>({1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15})},
          {Bytes<uint32_t>({6}), Bytes<uint32_t>({0, 1, 2, 3, 4})}};
}

std::span<const std::byte> View(const std::string& bytes, size_t first, size_t count) {
  return std::span(reinterpret_cast<const std::byte*>(bytes.data()), bytes.size()).subspan(first, count);
}

void AddSecond(const Column& column, Digest& digest) {
  digest.Add(Brick{{0, 0, 0}, {0xF0}}, View(column.second, 0, 4 * column.bytes()));
  digest.Add(Brick{{0, 7, 1}, {2}}, View(column.second, 4 * column.bytes(), column.bytes()));
}

// Returns answers with fields for each of the six voxels.
Answers AnswersWith(const Columns& columns) {
  Answers answers(kMesh.size());
  answers.accepted.mutable_accepted()->mutable_mesh()->set_triangles(7);
  v1::Certificate& certificate = *answers.summary.mutable_summary()->mutable_certificate();
  certificate.set_set("band");
  certificate.mutable_band()->set_width(2);
  certificate.set_signed_distance(true);
  certificate.set_interior_rule("winding");
  constexpr v1::Field kNumbers[] = {v1::FIELD_DISTANCE, v1::FIELD_COLOR, v1::FIELD_TRIANGLE};
  for (size_t n = 0; n < columns.size(); ++n) {
    answers.first.mutable_bricks()->add_fields()->set_values(columns[n].first);
    answers.second.mutable_bricks()->add_fields()->set_values(columns[n].second);
    Digest digest;
    digest.Add(Brick{{-1, 0, 0}, {1}}, View(columns[n].first, 0, columns[n].bytes()));
    AddSecond(columns[n], digest);
    v1::FieldCertificate& field = *certificate.add_fields();
    field.set_field(kNumbers[n]);
    field.set_digest(digest.ToHex());
  }
  return answers;
}

absl::StatusOr<Voxelization> Call(const VoxelizeRequest& request, const std::vector<v1::VoxelizeResponse>& answers) {
  return Fake(Send(answers)).client().VoxelizeAll(request, kMesh);
}

TEST(FieldsCall, PassesOnTheFieldsOfAllVoxelsInTheirOrder) {
  const auto all = Call(AskedFor(), AnswersWith(Good()).All());
  ASSERT_TRUE(all.ok()) << all.status();
  ASSERT_EQ(all->fields.size(), 3U);
  EXPECT_THAT(all->fields[0].As<float>(), ElementsAre(-2, 0, 1, 2, -0.5F, 1.5F));
  EXPECT_THAT(all->fields[1].As<uint8_t>().first(6), ElementsAre(255, 0, 9, 1, 2, 3));
  EXPECT_THAT(FindField(all->fields, Field::kTriangle)->As<uint32_t>(), ElementsAre(6, 0, 1, 2, 3, 4));
  EXPECT_EQ(FindField(all->fields, Field::kPart), nullptr);
  EXPECT_EQ(all->summary.certificate.fields[2].field, Field::kTriangle);
  // A width in voxels refers to the grid that the server reports.
  VoxelizeRequest in_voxels = AskedFor();
  in_voxels.set = Band{.width = 2, .in_voxels = true};
  EXPECT_TRUE(Call(in_voxels, AnswersWith(Good()).All()).ok());
}

// The bytes of each voxel in planes, as one zstd frame.
TEST(FieldsCall, ReadsCompressedValues) {
  Answers answers = AnswersWith(Good());
  for (v1::FieldValues& field : *answers.second.mutable_bricks()->mutable_fields()) {
    const std::string values = field.values();
    const size_t bytes = values.size() / 5;
    std::string planes;
    for (size_t n = 0; n < bytes; ++n) {
      for (size_t voxel = 0; voxel < 5; ++voxel) planes += values[voxel * bytes + n];
    }
    std::string frame(ZSTD_compressBound(planes.size()), '\0');
    frame.resize(ZSTD_compress(frame.data(), frame.size(), planes.data(), planes.size(), 1));
    field.set_values(frame);
    field.set_plain_bytes(static_cast<uint32_t>(values.size()));
  }
  const auto all = Call(AskedFor(), answers.All());
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_EQ(all->fields, Call(AskedFor(), AnswersWith(Good()).All())->fields);
  answers.second.mutable_bricks()->mutable_fields(0)->mutable_values()->pop_back();
  EXPECT_THAT(std::string(Call(AskedFor(), answers.All()).status().message()), HasSubstr("the field distance: "));
}

// The second batch's bricks lie in one tile.
TEST(FieldsCall, JoinsATileThatComesInParts) {
  const Answers answers = AnswersWith(Good());
  v1::VoxelizeResponse one = answers.second, other = answers.second;
  const auto cut = [](v1::VoxelizeResponse& part, int brick, size_t first, size_t count) {
    v1::BrickBatch& batch = *part.mutable_bricks();
    const v1::BrickBatch all = batch;
    batch.clear_brick_ijk();
    for (int m = 0; m < 3; ++m) batch.add_brick_ijk(all.brick_ijk(3 * brick + m));
    batch.set_masks(all.masks().substr(static_cast<size_t>(64 * brick), 64));
    for (v1::FieldValues& field : *batch.mutable_fields()) {
      const size_t bytes = field.values().size() / 5;
      field.set_values(field.values().substr(first * bytes, count * bytes));
    }
  };
  cut(one, 0, 0, 4);
  cut(other, 1, 4, 1);
  one.mutable_bricks()->set_tile_continues(true);
  const auto all = Call(AskedFor(), {answers.accepted, answers.first, one, other, answers.summary});
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_EQ(all->fields, Call(AskedFor(), answers.All())->fields);
  const absl::Status early = Call(AskedFor(), {answers.accepted, answers.first, one, answers.summary}).status();
  EXPECT_EQ(early.code(), absl::StatusCode::kDataLoss);
  one.mutable_bricks()->set_tile_continues(false);
  const absl::Status twice = Call(AskedFor(), {answers.accepted, answers.first, one, other, answers.summary}).status();
  EXPECT_THAT(std::string(twice.message()), HasSubstr("came twice"));
}

TEST(FieldsCall, EveryWrongValueIsDataLossThatNamesIt) {
  const auto breach = [](const VoxelizeRequest& asked, const Answers& answers, const char* says) {
    const absl::Status status = Call(asked, answers.All()).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(says));
  };
  // Another value comes with the right digest.
  const auto send = [&](size_t field, const std::string& second, const char* says) {
    Columns columns = Good();
    columns[field].second = second;
    breach(AskedFor(), AnswersWith(columns), says);
  };
  const auto change = [&](const std::function<void(Answers&)>& spoil, const char* says) {
    Answers answers = AnswersWith(Good());
    spoil(answers);
    breach(AskedFor(), answers, says);
  };
  const auto certify = [&](const std::function<void(v1::Certificate&)>& spoil, const char* says) {
    change([&](Answers& a) { spoil(*a.summary.mutable_summary()->mutable_certificate()); }, says);
  };
  send(0, Bytes<float>({0, 1, NAN, 0, 0}), "a distance of nan");
  send(0, Bytes<float>({0, 1, -INFINITY, 0, 0}), "a distance of -inf");
  send(0, Bytes<float>({0, 1, 2.0000002F, 0, 0}), "in a band of 2");
  send(0, Bytes<float>({0, 1, -0.0F, 0, 0}), "a distance of -0");
  send(2, Bytes<uint32_t>({0, 1, 7, 3, 4}), "the field triangle has the value 7");
  change([](Answers& a) { a.second.mutable_bricks()->mutable_fields(0)->mutable_values()->pop_back(); },
         "the field distance has 19 bytes for 5 voxels, not 20");
  change([](Answers& a) { a.second.mutable_bricks()->mutable_fields(1)->clear_values(); },
         "the field color has 0 bytes for 5 voxels, not 15");
  change([](Answers& a) { a.second.mutable_bricks()->mutable_fields()->RemoveLast(); }, "2 fields, not 3");
  change([](Answers& a) { (*a.second.mutable_bricks()->mutable_fields(1)->mutable_values())[3] ^= 1; },
         "the digest of the field color");
  certify([](v1::Certificate& c) { c.clear_band(); }, "a certificate without a band");
  certify([](v1::Certificate& c) { c.mutable_band()->set_width(3); }, "a band of 3 instead of 2");
  certify([](v1::Certificate& c) { c.set_set("surface"); }, "the set surface instead of band");
  certify([](v1::Certificate& c) { c.set_signed_distance(false); }, "distances without signs");
  certify([](v1::Certificate& c) { c.clear_interior_rule(); }, "a certificate without a rule for the inside");
  certify([](v1::Certificate& c) { c.mutable_fields()->RemoveLast(); }, "other fields than were asked for");
  certify([](v1::Certificate& c) { c.mutable_fields(0)->set_field(v1::FIELD_PART); }, "other fields");
  VoxelizeRequest without_signs = AskedFor(), nothing = AskedFor();
  without_signs.signed_distance = false;
  breach(without_signs, AnswersWith(Good()), "a distance of -2 without signs");
  VoxelizeRequest parity = AskedFor();
  parity.interior_rule = InteriorRule::kParity;
  breach(parity, AnswersWith(Good()), "the rule winding for the inside instead of parity");
  nothing.fields.clear();
  breach(nothing, AnswersWith(Good()), "a batch with 3 fields, not 0");
}

// Fields of links, with two neighbors.
TEST(FieldsCall, HaveANumberForEachNeighbor) {
  VoxelizeRequest asked;
  asked.set = Links{LinkSide::kBoth};
  asked.fields = {Field::kLinks, Field::kLinkTriangles, Field::kLinkCrossings};
  const Columns good = {{Bytes<float>({NAN, 1}), Bytes<float>({0x1p-126F, NAN, 1, 1, 1, 1, 1, 1, 1, 0.5F})},
                        {Bytes<uint32_t>({UINT32_MAX, 6}), Bytes<uint32_t>({0, UINT32_MAX, 2, 2, 2, 2, 2, 2, 2, 2})},
                        {Bytes<uint32_t>({0, 7}), Bytes<uint32_t>({1, 0, 1, 1, 1, 1, 1, 1, 1, 2})}};
  const auto answers_with = [](const Columns& columns) {
    Answers answers = AnswersWith(columns);
    for (const int32_t i : {-1, 1}) answers.accepted.mutable_accepted()->add_neighbors()->set_i(i);
    v1::Certificate& certificate = *answers.summary.mutable_summary()->mutable_certificate();
    certificate.set_set("links");
    certificate.clear_band();
    certificate.set_signed_distance(false);
    certificate.clear_interior_rule();
    constexpr v1::Field kNumbers[] = {v1::FIELD_LINKS, v1::FIELD_LINK_TRIANGLES, v1::FIELD_LINK_CROSSINGS};
    for (int n = 0; n < 3; ++n) certificate.mutable_fields(n)->set_field(kNumbers[n]);
    return answers;
  };
  const auto all = Call(asked, answers_with(good).All());
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_EQ(all->accepted.neighbors, (std::vector<Vec3i>{{-1, 0, 0}, {1, 0, 0}}));
  EXPECT_EQ(all->fields[1].components(), 2U);
  ForEachVoxel(*all, [](const Voxel& voxel) {
    if (voxel.number == 5) {
      EXPECT_THAT(voxel.Of<float>(Field::kLinks), ElementsAre(1, 0.5F));
    }
  });
  const auto breach = [&](size_t field, const std::string& first, const char* says) {
    Columns columns = good;
    columns[field].first = first;
    const absl::Status status = Call(asked, answers_with(columns).All()).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss);
    EXPECT_THAT(std::string(status.message()), HasSubstr(says));
  };
  breach(0, Bytes<float>({0, 1}), "the field links has the value 0");
  breach(0, Bytes<float>({NAN, 1.0000001F}), "the field links has the value 1");
  breach(1, Bytes<uint32_t>({UINT32_MAX, 7}), "the field link_triangles has the value 7");
  breach(2, Bytes<uint32_t>({0, 8}), "the field link_crossings has the value 8");
  const auto neighbors = [&](const std::vector<int32_t>& numbers, const char* says) {
    Answers answers = answers_with(good);
    answers.accepted.mutable_accepted()->clear_neighbors();
    for (const int32_t i : numbers) answers.accepted.mutable_accepted()->add_neighbors()->set_i(i);
    EXPECT_THAT(std::string(Call(asked, answers.All()).status().message()), HasSubstr(says));
  };
  neighbors({}, "0 neighbors");
  neighbors({1, -1}, "neighbor 1 is -1,0,0");
  neighbors({-1, 2}, "neighbor 0 is -1,0,0");
  neighbors({-1, -1, 1, 1}, "neighbor 1 is -1,0,0");
  neighbors(std::vector<int32_t>(28, 0), "28 neighbors, over 26");
}

TEST(FieldsCall, FractionsAreUpToTheNumberOfPoints) {
  VoxelizeRequest asked;
  asked.fields = {Field::kFraction};
  asked.fraction_n = 2;
  const auto answers_with = [](const std::vector<uint16_t>& second, uint32_t n) {
    Answers answers = AnswersWith({{Bytes<uint16_t>({8}), Bytes(second)}});
    v1::Certificate& certificate = *answers.summary.mutable_summary()->mutable_certificate();
    certificate.set_set("surface");
    certificate.clear_band();
    certificate.set_signed_distance(false);
    certificate.mutable_fields(0)->set_field(v1::FIELD_FRACTION);
    certificate.set_fraction_n(n);
    return answers;
  };
  const auto all = Call(asked, answers_with({0, 1, 2, 3, 7}, 2).All());
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_THAT(all->fields[0].As<uint16_t>(), ElementsAre(8, 0, 1, 2, 3, 7));
  EXPECT_EQ(all->summary.certificate.fraction_n, 2U);
  const auto message = [&](const Answers& answers) {
    return std::string(Call(asked, answers.All()).status().message());
  };
  EXPECT_THAT(message(answers_with({0, 1, 9, 3, 7}, 2)), HasSubstr("the field fraction has the value 9"));
  EXPECT_THAT(message(answers_with({0, 1, 2, 3, 7}, 3)), HasSubstr("fractions by 3 points instead of 2"));
}

TEST(FieldsCall, FractionsOfLabelsAreOfTheLabelsThatWereAskedFor) {
  VoxelizeRequest asked;
  asked.set = Solid{.labels = Field::kPart};
  asked.fields = {Field::kLabelFractions};
  asked.fraction_n = 2;
  using Labels = std::vector<uint32_t>;
  const auto call = [&](const Labels& accepted, const Labels& certified, uint16_t last) {
    Answers answers = AnswersWith({{Bytes<uint16_t>({8, 0}), Bytes<uint16_t>({0, 1, 2, 3, 4, 4, 0, 0, 1, last})}});
    v1::Certificate& certificate = *answers.summary.mutable_summary()->mutable_certificate();
    certificate.set_set("solid");
    certificate.clear_band();
    certificate.set_signed_distance(false);
    certificate.clear_interior_rule();
    certificate.mutable_fields(0)->set_field(v1::FIELD_LABEL_FRACTIONS);
    certificate.set_fraction_n(2);
    for (const uint32_t label : accepted) answers.accepted.mutable_accepted()->add_fraction_labels(label);
    for (const uint32_t label : certified) certificate.add_fraction_labels(label);
    return Call(asked, answers.All());
  };
  const auto all = call({3, 7}, {3, 7}, 5);
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_EQ(all->fields[0].labels, (Labels{3, 7}));
  ForEachVoxel(*all, [](const Voxel& voxel) {
    if (voxel.number == 5) {
      EXPECT_THAT(voxel.Of<uint16_t>(Field::kLabelFractions), ElementsAre(1, 5));
    }
  });
  const auto message = [&](const Labels& accepted, const Labels& certified, uint16_t last) {
    return std::string(call(accepted, certified, last).status().message());
  };
  EXPECT_THAT(message({3, 7}, {3, 7}, 9), HasSubstr("the field label_fractions has the value 9"));
  EXPECT_THAT(message({3, 7}, {3, 8}, 5), HasSubstr("fractions of other labels than Accepted has"));
  EXPECT_THAT(message({7, 3}, {7, 3}, 5), HasSubstr("fractions of the labels 7,3"));
  EXPECT_THAT(message({}, {}, 5), HasSubstr("0 labels of fractions"));
  EXPECT_THAT(message(Labels(33), {}, 5), HasSubstr("33 labels of fractions, over 32"));
  asked.fraction_labels = {7, 3};
  EXPECT_TRUE(call({7, 3}, {7, 3}, 5).ok());
  EXPECT_THAT(message({3, 7}, {3, 7}, 5), HasSubstr("fractions of the labels 3,7"));
}

// The first stream breaks after its first tile. The second one brings the rest, and counts and digests of the rest
// alone.
TEST(FieldsCall, AResumedStreamsDigestsAreThoseOfAll) {
  const Answers answers = AnswersWith(Good());
  std::atomic<int> calls = 0;
  const Fake fake([&](grpc::ServerContext*, Stream* stream) {
    v1::VoxelizeRequest request;
    stream->Read(&request);
    EXPECT_EQ(request.spec().band().width(), 2);
    EXPECT_TRUE(request.spec().signed_distance());
    EXPECT_THAT(request.spec().fields(), ElementsAre(v1::FIELD_DISTANCE, v1::FIELD_COLOR, v1::FIELD_TRIANGLE));
    while (stream->Read(&request)) continue;
    stream->Write(answers.accepted);
    if (calls++ == 0) {
      stream->Write(answers.first);
      return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone");
    }
    v1::VoxelizeResponse end = answers.summary;
    v1::Certificate& certificate = *end.mutable_summary()->mutable_certificate();
    Digest digest;
    digest.Add(Brick{{0, 0, 0}, {0xF0}});
    digest.Add(Brick{{0, 7, 1}, {2}});
    certificate.set_digest(digest.ToHex());
    const Columns columns = Good();
    for (size_t n = 0; n < columns.size(); ++n) {
      Digest of_field;
      AddSecond(columns[n], of_field);
      certificate.mutable_fields(static_cast<int>(n))->set_digest(of_field.ToHex());
    }
    end.mutable_summary()->set_voxels(5);
    end.mutable_summary()->set_bricks(2);
    end.mutable_summary()->set_tiles(1);
    stream->Write(answers.second);
    stream->Write(end);
    return grpc::Status::OK;
  });
  const auto all = fake.client().VoxelizeAll(AskedFor(), kMesh);
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(all->fields[0].bytes.size(), 24U);
  for (int n = 0; n < 3; ++n) {
    EXPECT_EQ(all->summary.certificate.fields[static_cast<size_t>(n)].digest,
              answers.summary.summary().certificate().fields(n).digest());
  }
}

}  // namespace
}  // namespace latvox::client
