// Runs the kernels of core/tile/tile_bits.cc, and compares them with plain C++. compile_test.py compiles both files for
// ARM without a library of ARM's beside the compiler's own, and an emulator runs them. Ends with status 0 if all is
// equal.
#include "core/tile/tile_bits.h"

#include <cstdio>
#include <random>
#include <vector>

#include "core/base/simd.h"

namespace latvox {
namespace {

bool is_scalar = false;

constexpr size_t kWords = 4096;
using Words = std::vector<uint32_t>;

void Append(const NumberList& list, Words& to) {
  to.push_back(static_cast<uint32_t>(list.size()));
  to.insert(to.end(), list.view().begin(), list.view().end());
}

// Returns everything that the kernels say of some numbers and some members.
Words Answers(const Words& numbers, const Words& members) {
  TileBits bits(kWords);
  bits.SetAll(members);
  Words answers = bits.words();
  NumberList in, others, out;
  for (const bool in_set : {false, true}) {
    bits.Find(numbers, in_set, in);
    Append(in, answers);
  }
  bits.FindFew(numbers, members, in);
  Append(in, answers);
  in.Clear();
  Words positions(numbers.size());
  for (size_t n = 0; n < positions.size(); ++n) positions[n] = static_cast<uint32_t>(n);
  bits.Separate(numbers, positions, in, others, out);
  for (const NumberList* list : {&in, &others, &out}) Append(*list, answers);
  const NumberRange range = RangeOf(numbers);
  answers.insert(answers.end(), {range.first, range.last});
  return answers;
}

int Main() {
  std::mt19937 random(1);
  size_t compared = 0;
  for (const size_t count : {0, 1, 3, 4, 5, 63, 64, 255, 256, 1023, 1024, 1025, 5000}) {
    for (const size_t members : {0, 1, 7, 100, 3000}) {
      const auto some = [&](size_t size) {
        Words made(size);
        for (uint32_t& each : made) each = random() % (kWords * 32);
        return made;
      };
      Words numbers = some(count);
      const Words set = some(members);
      for (uint32_t& each : numbers) each |= random() << kNumberBits;  // a lane above them
      is_scalar = true;
      const Words expected = Answers(numbers, set);
      is_scalar = false;
      if (Answers(numbers, set) != expected) {
        std::printf("%zu numbers, %zu members: the kernels differ from plain C++\n", count, members);
        return 1;
      }
      compared += expected.size();
    }
  }
  std::printf("%zu words are equal\n", compared);
  return 0;
}

}  // namespace

bool SimdIsScalar() { return is_scalar; }

}  // namespace latvox

int main() { return latvox::Main(); }
