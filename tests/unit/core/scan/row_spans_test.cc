// The lines of a row within rims and edges, compared with each line's edge functions in integers.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/unit/core/scan/row_spans_test.cc"
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <array>
#include <cstdint>
#include <span>

#include "core/scan/row_spans-inl.h"

namespace latvox {
#ifndef LATVOX_TESTS_UNIT_CORE_ROW_SPANS_TEST_CC_ONCE
#define LATVOX_TESTS_UNIT_CORE_ROW_SPANS_TEST_CC_ONCE
namespace {

// A row, and the result of RowSpans for it.
struct Row {
  std::array<int32_t, 3> edge, step, rim;
  int32_t lines;
  bool exact;
  int32_t begin, end, inner_begin, inner_end;
};

}  // namespace
#endif
}  // namespace latvox

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR
void AskRowSpans(std::span<Row>) {}
#else

// A whole number of vectors.
void AskRowSpans(std::span<Row> rows) {
  const Lanes d;
  for (size_t first = 0; first < rows.size(); first += kTriangleLanes) {
    const std::span<Row> some = rows.subspan(first, kTriangleLanes);
    alignas(64) int32_t lanes[kTriangleLanes];
    const auto load = [&](auto&& of) HWY_ATTR {
      for (size_t n = 0; n < kTriangleLanes; ++n) lanes[n] = of(some[n]);
      return hn::Load(d, lanes);
    };
    const auto store = [&](Ints v, int32_t Row::*to) HWY_ATTR {
      hn::Store(v, d, lanes);
      for (size_t n = 0; n < kTriangleLanes; ++n) some[n].*to = lanes[n];
    };
    Ints edge[3], step[3], rim[3];
    for (size_t m = 0; m < 3; ++m) {
      edge[m] = load([m](const Row& row) { return row.edge[m]; });
      step[m] = load([m](const Row& row) { return row.step[m]; });
      rim[m] = load([m](const Row& row) { return row.rim[m]; });
    }
    const RowSpans row_spans(step, rim, load([](const Row& row) { return row.lines; }));
    const auto spans = row_spans.Of(edge);
    store(spans.begin, &Row::begin);
    store(spans.end, &Row::end);
    store(spans.inner_begin, &Row::inner_begin);
    store(spans.inner_end, &Row::inner_end);
    const uint64_t exact = BitsOf(row_spans.exact());
    for (size_t n = 0; n < kTriangleLanes; ++n) some[n].exact = (exact >> n & 1) != 0;
  }
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "core/base/simd.h"
#include "tests/unit/core/simd.h"
#include "tests/unit/core/triangles.h"

namespace latvox {
namespace {

HWY_EXPORT(AskRowSpans);

constexpr int32_t kMostStep = (1 << 15) - 1, kMostRim = (1 << 18) - 1, kMostLines = 64;

// Returns whether no edge function is negative on a line, with or without `rims` added.
bool IsWithin(const Row& row, int32_t line, bool rims) {
  bool is_within = true;
  for (size_t m = 0; m < 3; ++m) {
    is_within &= int64_t{row.edge[m]} + int64_t{row.step[m]} * line + (rims ? row.rim[m] : 0) >= 0;
  }
  return is_within;
}

void ExpectRight(std::vector<Row> rows) {
  constexpr size_t kWhole = 16;  // of the widest vectors
  ASSERT_EQ(rows.size() % kWhole, 0U);
  for (const Simd simd : SimdHere()) {
    if (simd == Simd::kScalar) continue;
    const ForcedSimd forced(simd);
    HWY_DYNAMIC_DISPATCH(AskRowSpans)(rows);
    for (const Row& row : rows) {
      ASSERT_TRUE(row.exact);
      for (const int32_t bound : {row.begin, row.end, row.inner_begin, row.inner_end}) {
        ASSERT_GE(bound, 0);
        ASSERT_LE(bound, row.lines);
      }
      for (int32_t line = 0; line < row.lines; ++line) {
        ASSERT_EQ(row.begin <= line && line < row.end, IsWithin(row, line, true))
            << SimdInUse() << " line " << line << " of " << row.lines << " steps " << row.step[0] << " " << row.step[1]
            << " " << row.step[2] << " edges " << row.edge[0] << " " << row.edge[1] << " " << row.edge[2];
        ASSERT_EQ(row.inner_begin <= line && line < row.inner_end, IsWithin(row, line, false)) << SimdInUse();
      }
    }
  }
}

// Each edge function, with or without its rim, is next to 0 on a line of the row or a little beyond.
TEST(RowSpans, AreRightWhereEdgesPassLinesCloselyOnEachKernel) {
  std::mt19937 random(kSeed);
  const auto any = [&](int32_t low, int32_t high) { return std::uniform_int_distribution(low, high)(random); };
  std::vector<Row> rows(Dose(1 << 16, 1 << 12));
  for (Row& row : rows) {
    row.lines = any(1, kMostLines);
    for (size_t m = 0; m < 3; ++m) {
      const int32_t most = any(0, 1) == 0 ? kMostStep : 300;
      row.step[m] = any(0, 3) == 0 ? (any(0, 1) * 2 - 1) * most : any(-most, most);
      row.rim[m] = any(0, 1) == 0 ? any(-kMostRim, kMostRim) : any(-1000, 1000);
      const int32_t line = any(-2, row.lines + 1), rim = any(0, 1) * row.rim[m];
      row.edge[m] = -row.step[m] * line - rim + any(-2, 1);
    }
  }
  ExpectRight(rows);
}

TEST(RowSpans, AreRightWhereEdgesAreFarAwayOrParallelToRowsOnEachKernel) {
  std::mt19937 random(kSeed);
  const auto any = [&](int32_t low, int32_t high) { return std::uniform_int_distribution(low, high)(random); };
  std::vector<Row> rows(Dose(1 << 16, 1 << 12));
  for (Row& row : rows) {
    row.lines = any(1, kMostLines);
    for (size_t m = 0; m < 3; ++m) {
      row.step[m] = any(0, 1) * any(-3, 3);
      row.rim[m] = any(-kMostRim, kMostRim);
      const int32_t bits = any(1, 27);
      row.edge[m] = any(0, 2) == 0 ? -row.rim[m] + any(-1, 0) : any(-(1 << bits), 1 << bits);
    }
  }
  ExpectRight(rows);
}

TEST(RowSpans, SayWhereTheyMayBeWrongOnEachKernel) {
  const Row row{{0, 0, 0}, {kMostStep, -kMostStep, 0}, {0, 0, kMostRim}, 5, false, 0, 0, 0, 0};
  std::vector<Row> rows(16, row);
  rows[0].step[0] = kMostStep + 1;
  rows[3].step[1] = -kMostStep - 1;
  rows[7].rim[2] = kMostRim + 1;
  for (const Simd simd : SimdHere()) {
    if (simd == Simd::kScalar) continue;
    const ForcedSimd forced(simd);
    HWY_DYNAMIC_DISPATCH(AskRowSpans)(rows);
    for (size_t n = 0; n < rows.size(); ++n) EXPECT_EQ(rows[n].exact, n != 0 && n != 3 && n != 7) << SimdInUse();
  }
}

}  // namespace
}  // namespace latvox
#endif  // HWY_ONCE
