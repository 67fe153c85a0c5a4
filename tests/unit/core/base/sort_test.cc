// Sorting gives the standard library's result, and ends soon once stopped.
#include "core/base/sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "core/base/stop_signal.h"

namespace latvox {
namespace {

TEST(Sorting, IsThatOfTheLibraryAndStops) {
  std::mt19937 random(3);
  for (const size_t size : {size_t{0}, size_t{1}, size_t{1} << 16, size_t{1000000}}) {
    std::vector<uint32_t> numbers(size);
    for (uint32_t& number : numbers) number = static_cast<uint32_t>(random() % 100000);
    std::vector<uint32_t> expected = numbers, unsorted = numbers;
    std::sort(expected.begin(), expected.end());
    Sort(numbers, StopSignal());
    EXPECT_EQ(numbers, expected);
    expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
    std::vector<uint32_t> unique = unsorted;
    SortUnique(unique, StopSignal());
    EXPECT_EQ(unique, expected);
    const std::vector<uint32_t> before = unsorted;
    StopSource stopped;
    stopped.Stop();
    Sort(unsorted, stopped.Signal());
    EXPECT_EQ(unsorted, before);
  }
}

// At every stage: sorting pieces, four fifths of all comparisons here, and merging them, in the end all at once.
TEST(Sorting, StopsWithinAPieceAndLosesNothing) {
  constexpr uint64_t kToSortAPiece = 2 * kSortedPiece * std::bit_width(kSortedPiece);  // comparisons
  std::mt19937 random(4);
  std::vector<uint32_t> unsorted(1000000);
  for (uint32_t& number : unsorted) number = static_cast<uint32_t>(random() % 100000);
  std::vector<uint32_t> expected = unsorted;
  std::sort(expected.begin(), expected.end());
  std::optional<StopSource> source(std::in_place);
  uint64_t compared = 0, last = ~uint64_t{0};
  const auto less = [&](uint32_t a, uint32_t b) {
    if (++compared == last) source->Stop();
    return a < b;
  };
  std::vector<uint32_t> numbers = unsorted;
  Sort(numbers, source->Signal(), less);
  EXPECT_EQ(numbers, expected);
  const uint64_t whole = compared;
  for (const double part : {0.1, 0.5, 0.8, 0.9, 0.95, 0.98}) {
    numbers = unsorted;
    source.emplace();
    compared = 0;
    last = static_cast<uint64_t>(part * static_cast<double>(whole));
    Sort(numbers, source->Signal(), less);
    EXPECT_LT(compared - last, part < 0.85 ? kToSortAPiece : kSortedPiece + 1) << part;
    EXPECT_NE(numbers, expected);
    std::sort(numbers.begin(), numbers.end());
    EXPECT_EQ(numbers, expected);
  }
}

}  // namespace
}  // namespace latvox
