// Numbers in texts: each is the nearest double, whichever way reads it.
#include "client/mesh_files/number_text.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>

namespace latvox::client {
namespace {

void ExpectNearest(const std::string& word) {
  double value = 0;
  ASSERT_TRUE(ParseDouble(word, value)) << word;
  EXPECT_EQ(std::bit_cast<uint64_t>(value), std::bit_cast<uint64_t>(std::strtod(word.c_str(), nullptr))) << word;
}

TEST(ParseDouble, GivesTheNearestDouble) {
  for (const char* word : {"0",
                           "-0",
                           "-0.0",
                           "5.",
                           ".5",
                           "-.5",
                           "0.1",
                           "1.7",
                           "100",
                           "+3.25",
                           "999999999999999",
                           "999999999999999.9",
                           "9007199254740993",
                           "0.000000000000001",
                           "123456789012345.6",
                           "1e5",
                           "-2.5E-3",
                           "1e-320",
                           "1e400",
                           "inf",
                           "18446744073709551616",
                           "0000000000000000001.5"}) {
    ExpectNearest(word);
  }
}

TEST(ParseDouble, GivesTheNearestDoubleOfRandomDigits) {
  std::mt19937_64 random(41);
  for (int n = 0; n < 20000; ++n) {
    const size_t count = 1 + random() % 20, point = random() % (count + 1);
    std::string word = random() % 2 == 0 ? "-" : "";
    for (size_t digit = 0; digit < count; ++digit) {
      if (digit == point) word += '.';
      word += static_cast<char>('0' + random() % 10);
    }
    ExpectNearest(word);
  }
}

TEST(ParseDouble, RefusesOtherWords) {
  for (const char* word : {"", "-", "+", ".", "-.", "1.2.3", "1,5", "0x10", "1e", "--1", "1 2", "abc", "12a"}) {
    double value = 0;
    EXPECT_FALSE(ParseDouble(word, value)) << word;
  }
  for (const char* word : {"1.#IND", "-1.#QNAN", "nan"}) {
    double value = 0;
    EXPECT_TRUE(ParseDouble(word, value) && std::isnan(value)) << word;
  }
}

}  // namespace
}  // namespace latvox::client
