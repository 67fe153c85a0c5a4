// Large pages, and the arrays that consist of them.
#include "core/base/huge_pages.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <algorithm>
#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <new>
#include <string>
#include <vector>

#include "core/base/uninitialized.h"

namespace latvox {
namespace {

#ifdef LATVOX_EMULATED  // the emulator passes no wish for them on to the kernel
bool KernelMarksThem() { return false; }
#else
bool KernelMarksThem() { return std::filesystem::exists("/sys/kernel/mm/transparent_hugepage"); }
#endif

// The flags of the mapping that holds an address.
std::string MappingFlags(uintptr_t address) {
  std::ifstream maps("/proc/self/smaps");
  bool here = false;
  for (std::string line; std::getline(maps, line);) {
    uintptr_t begin = 0, end = 0;
    if (std::sscanf(line.c_str(), "%" SCNxPTR "-%" SCNxPTR " ", &begin, &end) == 2) {
      here = begin <= address && address < end;
    }
    if (here && line.starts_with("VmFlags:")) return line + " ";
  }
  return "";
}

TEST(HugePages, AreAskedForWithinLargeArraysAlone) {
  if (!KernelMarksThem()) GTEST_SKIP() << "the kernel has none, or does not learn of the wish";
  constexpr size_t kSize = 8 * kHugePage;
  void* const memory = mmap(nullptr, kSize, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  const auto begin = reinterpret_cast<uintptr_t>(memory);
  AdviseHugePages(memory, kHugePage / 2);
  EXPECT_EQ(MappingFlags(begin).find(" hg "), std::string::npos);
  AdviseHugePages(static_cast<char*>(memory) + kHugePage, kSize - 2 * kHugePage);
  EXPECT_NE(MappingFlags(begin + kSize / 2).find(" hg "), std::string::npos);
  EXPECT_EQ(MappingFlags(begin).find(" hg "), std::string::npos);
  EXPECT_EQ(MappingFlags(begin + kSize - 1).find(" hg "), std::string::npos);
  munmap(memory, kSize);
}

TEST(HugePages, AreKeptByDefault) {
  void* const array = AllocatePages(1);
  FreePages(array, 1);
  EXPECT_EQ(AllocatePages(1), array);
  FreePages(array, 1);
}

TEST(HugePages, AreGivenBackWholeWhereNoneAreKept) {
  KeepPages(0);
  for (const size_t bytes : {size_t{1}, kHugePage, kHugePage + 1}) {
    std::vector<void*> arrays;  // some happen to follow each other
    for (int n = 0; n < 8; ++n) arrays.push_back(AllocatePages(bytes));
    for (void* const array : arrays) std::memset(array, 1, bytes);
    for (void* const array : arrays) {
      const auto begin = reinterpret_cast<uintptr_t>(array);
      EXPECT_EQ(begin % kHugePage, 0U);
      FreePages(array, bytes);
      EXPECT_EQ(MappingFlags(begin), "");
      EXPECT_EQ(MappingFlags(begin + bytes - 1), "");
    }
  }
  EXPECT_THROW(AllocatePages(size_t{1} << 62), std::bad_alloc);
}

TEST(HugePages, AreKeptForArraysOfTheSameSizeUpToALimit) {
  const auto address = [](void* array) { return reinterpret_cast<uintptr_t>(array); };
  KeepPages(3 * kHugePage);
  void* const one = AllocatePages(1);
  void* const two = AllocatePages(kHugePage + 1);
  FreePages(one, 1);
  FreePages(two, kHugePage + 1);
  EXPECT_EQ(AllocatePages(2 * kHugePage), two);
  EXPECT_EQ(AllocatePages(kHugePage), one);
  FreePages(one, kHugePage);
  FreePages(two, 2 * kHugePage);
  void* const large = AllocatePages(4 * kHugePage);
  FreePages(large, 4 * kHugePage);  // more than the limit
  EXPECT_EQ(MappingFlags(address(large)), "");
  void* const other = AllocatePages(3 * kHugePage);
  FreePages(other, 3 * kHugePage);  // and the first to go is the oldest
  EXPECT_EQ(MappingFlags(address(one)), "");
  EXPECT_EQ(MappingFlags(address(two)), "");
  EXPECT_NE(MappingFlags(address(other)), "");
  std::vector<void*> many;  // more than it has places for
  KeepPages(64 * kHugePage);
  for (int n = 0; n < 40; ++n) many.push_back(AllocatePages(1));
  for (void* const array : many) FreePages(array, 1);
  EXPECT_EQ(MappingFlags(address(many.front())), "");
  EXPECT_NE(MappingFlags(address(many.back())), "");
  EXPECT_EQ(AllocatePages(1), many.back());  // the newest
  FreePages(many.back(), 1);
  FreePages(AllocatePages(2 * kHugePage), 2 * kHugePage);  // in the place of the oldest
  void* const again = AllocatePages(2 * kHugePage);
  for (int n = 0; n < 40; ++n) FreePages(AllocatePages(1), 1);  // the same one, which takes one place
  FreePages(again, 2 * kHugePage);
  EXPECT_EQ(MappingFlags(address(many[40 - kKeptArrays])), "");
  EXPECT_NE(MappingFlags(address(many[41 - kKeptArrays])), "");
  KeepPages(0);
  EXPECT_EQ(MappingFlags(address(many.back())), "");
  EXPECT_EQ(MappingFlags(address(other)), "");
}

TEST(HugePages, AreWhatLargeUninitializedArraysConsistOf) {
  for (const size_t bytes : {kHugePage, kHugePage + 1, 5 * kHugePage / 2}) {
    UninitializedVector<uint8_t> array(bytes);
    PaddedVector<uint8_t> padded(bytes - 1);  // and one more
    std::fill(array.begin(), array.end(), 1);
    std::fill(padded.begin(), padded.end(), 1);
    if (bytes == kHugePage) continue;
    for (const uint8_t* data : {array.data(), padded.data()}) {
      const auto begin = reinterpret_cast<uintptr_t>(data);
      EXPECT_EQ(begin % kHugePage, 0U) << bytes;
      if (!KernelMarksThem()) continue;
      EXPECT_NE(MappingFlags(begin).find(" hg "), std::string::npos) << bytes;
      EXPECT_NE(MappingFlags(begin + bytes - 1).find(" hg "), std::string::npos) << bytes;
    }
  }
}

}  // namespace
}  // namespace latvox
