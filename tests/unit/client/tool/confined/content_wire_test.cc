#include "client/tool/confined/content_wire.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "tests/unit/client/fields.h"

namespace latvox::client {
namespace {

using testing::HasSubstr;

GridContent Whole() {
  GridContent content;
  GridFileInfo& info = content.file.info;
  info.name = "voxels";
  info.value_type = "bool";
  info.transform = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}, 1};
  info.active_voxels = 3;
  info.active_box = IndexBox{{-8, 0, 0}, {1, 1, 2}};
  info.metadata = {{"latvox_digest", "12"}, {"empty", ""}};
  content.file.bricks = {{{-1, 0, 0}, {1, 0, 0, 0, 0, 0, 0, 0}}, {{0, 0, 0}, {3, 0, 0, 0, 0, 0, 0, 0}}};
  content.fields = {
      ValuesOf<uint32_t>(Field::kPart, {1, 2, 3}), ValuesOf<uint8_t>(Field::kColor, {1, 2, 3, 4, 5, 6, 7, 8, 9}),
      ValuesOf<float>(Field::kDistance, {0, -1, 2}), ValuesOf<uint16_t>(Field::kLabelFractions, {8, 0, 1, 2, 3, 4})};
  content.fields.back().labels = {7, 3};
  content.distances = DistanceRange{2, true};
  return content;
}

std::string Bytes(const absl::StatusOr<GridContent>& content) {
  std::string bytes;
  SendContent(content,
              [&bytes](const void* from, size_t count) { bytes.append(static_cast<const char*>(from), count); });
  return bytes;
}

absl::StatusOr<GridContent> Read(const std::string& bytes) {
  size_t at = 0;
  return ReceiveContent(/*facts_alone=*/false, [&](void* to, size_t count) {
    if (count > bytes.size() - at) return absl::DataLossError("the end");
    std::memcpy(to, bytes.data() + at, count);
    at += count;
    return absl::OkStatus();
  });
}

TEST(ContentWire, TellsAWholeContent) {
  const auto content = Read(Bytes(Whole()));
  ASSERT_TRUE(content.ok()) << content.status();
  EXPECT_EQ(Bytes(*content), Bytes(Whole()));
  EXPECT_EQ(content->file.info.metadata, Whole().file.info.metadata);
  EXPECT_EQ(content->fields, Whole().fields);
  EXPECT_EQ(content->distances, Whole().distances);
}

TEST(ContentWire, TellsABand) {
  GridContent band = Whole();
  band.is_band = true;
  band.fields = {band.fields[2]};
  const auto content = Read(Bytes(band));
  ASSERT_TRUE(content.ok()) << content.status();
  EXPECT_TRUE(content->is_band);
  EXPECT_TRUE(content->distances->is_signed);
  EXPECT_EQ(content->fields, band.fields);
}

GridContent WithLinks() {
  GridContent content = Whole();
  content.neighbors = {{-1, 0, 2}, {1, 0, -2}};
  content.fields = {ValuesOf<float>(Field::kLinks, {0.5F, 1, std::nanf(""), 0.25F, 1, std::nanf("")}),
                    ValuesOf<uint32_t>(Field::kLinkCrossings, {1, 2, 0, 1, 3, 0})};
  for (FieldValues& values : content.fields) values.neighbors = 2;
  content.distances.reset();
  return content;
}

TEST(ContentWire, TellsLinks) {
  const auto content = Read(Bytes(WithLinks()));
  ASSERT_TRUE(content.ok()) << content.status();
  EXPECT_EQ(content->fields, WithLinks().fields);
  EXPECT_EQ(content->neighbors, WithLinks().neighbors);
}

TEST(ContentWire, BelievesNothingAboutLinks) {
  const std::function<void(GridContent&)> lies[] = {
      [](GridContent& c) { c.neighbors.clear(); },
      [](GridContent& c) { c.neighbors.pop_back(); },
      [](GridContent& c) { std::swap(c.neighbors[0], c.neighbors[1]); },
      [](GridContent& c) { c.neighbors[1][2] = -1; },
      [](GridContent& c) {
        c.neighbors = {{0, 0, 0}, {0, 0, 0}};
      },
      [](GridContent& c) {
        c.neighbors = {{INT32_MIN, 0, 0}, {INT32_MIN, 0, 0}};
      },
      [](GridContent& c) {
        c.neighbors = {{-2, 0, 0}, {-1, 0, 0}, {1, 0, 0}, {2, 0, 0}};
      },
      [](GridContent& c) {
        c.neighbors.clear();
        for (int32_t n = -14; n <= 14; ++n) {
          if (n != 0) c.neighbors.push_back({n, 0, 0});
        }
        for (FieldValues& values : c.fields) values.bytes.resize(size_t{3} * 28 * 4);
      },
      [](GridContent& c) {
        c.fields[0] = ValuesOf<float>(Field::kLinks, {0.5F, 1, HUGE_VALF, 0.25F, 1, 1});
      },
      [](GridContent& c) {
        c.fields[0] = ValuesOf<float>(Field::kLinks, {0.5F, 1, -5, 0.25F, 1, 1});
      },
      [](GridContent& c) {
        c.fields[0] = ValuesOf<float>(Field::kLinks, {0.5F, 1, 1.5F, 0.25F, 1, 1});
      },
      [](GridContent& c) { c.fields.clear(); },
      [](GridContent& c) { c.fields[0].bytes.pop_back(); },
      [](GridContent& c) { c.fields[1].labels = {7}; },
  };
  for (const auto& lie : lies) {
    GridContent content = WithLinks();
    lie(content);
    EXPECT_EQ(Read(Bytes(content)).status().code(), absl::StatusCode::kDataLoss) << &lie - lies;
  }
}

TEST(ContentWire, TellsErrorsOfTwoKindsWithoutControlCharacters) {
  const auto bad = Read(Bytes(absl::InvalidArgumentError("a\x1b[1m.vdb: is bad"))).status();
  EXPECT_EQ(bad.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(bad.message()), HasSubstr("a\\x1b[1m.vdb: is bad"));
  EXPECT_EQ(Read(Bytes(absl::ResourceExhaustedError("no"))).status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(Read(Bytes(absl::UnauthenticatedError("no"))).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(ContentWire, BelievesNothing) {
  const std::function<void(GridContent&)> lies[] = {
      [](GridContent& c) { c.file.bricks[0].mask[0] = 0; },
      [](GridContent& c) { std::swap(c.file.bricks[0], c.file.bricks[1]); },
      [](GridContent& c) { c.file.bricks[1] = c.file.bricks[0]; },
      [](GridContent& c) { c.file.bricks[1].brick_ijk[2] = 1 << 29; },
      [](GridContent& c) { c.file.bricks.pop_back(); },
      [](GridContent& c) { ++c.file.info.active_voxels; },
      [](GridContent& c) { c.file.info.active_box.reset(); },
      [](GridContent& c) { c.file.info.active_box->max[0] = 100; },
      [](GridContent& c) { c.file.info.active_box->min[1] = 100; },
      [](GridContent& c) { c.file.info.transform.origin[1] = std::nan(""); },
      [](GridContent& c) { c.fields[0].bytes.pop_back(); },
      [](GridContent& c) { c.fields[0].bytes.resize(16); },
      [](GridContent& c) { c.fields[0].field = Field::kPoint; },
      [](GridContent& c) { c.fields[0].field = static_cast<Field>(77); },
      [](GridContent& c) { std::swap(c.fields[0], c.fields[1]); },
      [](GridContent& c) { c.fields[1] = c.fields[0]; },
      [](GridContent& c) { c.fields.erase(c.fields.begin() + 2); },
      [](GridContent& c) { c.fields[0].labels = {7}; },
      [](GridContent& c) { c.fields[3].labels.clear(); },
      [](GridContent& c) { c.fields[3].labels.pop_back(); },
      [](GridContent& c) {
        c.fields[3].labels.resize(33);
        c.fields[3].bytes.resize(size_t{3} * 33 * 2);
      },
      [](GridContent& c) {
        c.fields[2] = ValuesOf<float>(Field::kDistance, {1, 2, HUGE_VALF});
      },
      [](GridContent& c) { c.distances.reset(); },
      [](GridContent& c) { c.distances->most = std::nan(""); },
  };
  for (const auto& lie : lies) {
    GridContent content = Whole();
    lie(content);
    EXPECT_EQ(Read(Bytes(content)).status().code(), absl::StatusCode::kDataLoss) << &lie - lies;
  }
}

TEST(ContentWire, AnEndAnywhereIsAnError) {
  const std::string whole = Bytes(Whole());
  for (size_t length = 0; length < whole.size(); ++length) {
    EXPECT_EQ(Read(whole.substr(0, length)).status().code(), absl::StatusCode::kDataLoss) << length;
  }
}

// A count of 2^64 - 1 would take all memory, or overflow.
TEST(ContentWire, ACountTakesNoMemoryBeforeItsBytesCome) {
  const std::string whole = Bytes(Whole());
  for (size_t at = 0; at + 8 <= whole.size(); ++at) {
    std::string bad = whole;
    bad.replace(at, 8, 8, '\xff');
    Read(bad).IgnoreError();
  }
}

}  // namespace
}  // namespace latvox::client
