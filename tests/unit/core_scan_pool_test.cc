// What jobs leave to later ones.
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "core/base/kept_memory.h"
#include "core/voxelizer/scan_pool.h"

namespace latvox {
namespace {

class ScanPoolTest : public testing::Test {
 protected:
  ~ScanPoolTest() override { kept_scan_bytes = 0; }
};

template <int kNumber>
struct Sized {
  bool used = false;
  size_t Bytes() const { return 10; }
};

// Has a job use so many scans at a time, and leave them; returns how many had been used before.
template <class Scan>
int UsedBefore(int count) {
  ScanPool<Scan> pool;
  std::vector<std::unique_ptr<Scan>> scans;
  int used = 0;
  for (int n = 0; n < count; ++n) {
    scans.push_back(pool.Take());
    used += scans.back()->used ? 1 : 0;
    scans.back()->used = true;
  }
  for (auto& scan : scans) pool.Give(std::move(scan));
  pool.Leave();
  return used;
}

TEST_F(ScanPoolTest, LeavesNoneUnlessMemoryIsKept) {
  EXPECT_EQ(UsedBefore<Sized<0>>(3), 0);
  EXPECT_EQ(UsedBefore<Sized<0>>(3), 0);
}

TEST_F(ScanPoolTest, LeavesScansUpToALimit) {
  kept_scan_bytes = 29;
  EXPECT_EQ(UsedBefore<Sized<1>>(4), 0);
  EXPECT_EQ(UsedBefore<Sized<1>>(1), 1);
  EXPECT_EQ(UsedBefore<Sized<1>>(4), 2);
  kept_scan_bytes = 0;
  EXPECT_EQ(UsedBefore<Sized<1>>(4), 2);
  EXPECT_EQ(UsedBefore<Sized<1>>(4), 0);
}

}  // namespace
}  // namespace latvox
