// Limits of control groups are found wherever a container, a batch system or a service has them.
#include "server/base/control_group.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace latvox {
namespace {

class ControlGroup : public testing::Test {
 protected:
  ControlGroup() : root_(testing::TempDir() + testing::UnitTest::GetInstance()->current_test_info()->name()) {
    std::filesystem::remove_all(root_);
  }
  ~ControlGroup() override { std::filesystem::remove_all(root_); }

  void Write(const std::string& path, const std::string& text) {
    const std::filesystem::path file = root_ + path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }

  ControlGroupLimits Limits() const { return LimitsOfControlGroups(root_); }

  const std::string root_;
};

TEST_F(ControlGroup, NoneIsNoLimit) {
  EXPECT_EQ(Limits().memory_bytes, UINT64_MAX);
  EXPECT_EQ(Limits().cores, 0);
  Write("/proc/self/cgroup", "0::/a\nno line of this kind\n");
  Write("/sys/fs/cgroup/a/memory.max", "max\n");
  Write("/sys/fs/cgroup/a/cpu.max", "max 100000\n");
  EXPECT_EQ(Limits().memory_bytes, UINT64_MAX);
  EXPECT_EQ(Limits().cores, 0);
}

TEST_F(ControlGroup, OfVersion2InAContainerIsTheOutermostThatIsSeen) {
  Write("/proc/self/cgroup", "0::/\n");
  Write("/sys/fs/cgroup/memory.max", "536870912\n");
  Write("/sys/fs/cgroup/cpu.max", "150000 100000\n");
  EXPECT_EQ(Limits().memory_bytes, 536870912);
  EXPECT_EQ(Limits().cores, 2);
}

TEST_F(ControlGroup, TheTightestOfThoseAroundCounts) {
  Write("/proc/self/cgroup", "0::/slurm/job_7/step_0\n");
  Write("/sys/fs/cgroup/slurm/memory.max", "9000\n");
  Write("/sys/fs/cgroup/slurm/job_7/memory.max", "7000\n");
  Write("/sys/fs/cgroup/slurm/job_7/step_0/memory.max", "8000\n");
  Write("/sys/fs/cgroup/slurm/cpu.max", "400000 100000\n");
  Write("/sys/fs/cgroup/slurm/job_7/step_0/cpu.max", "300000 100000\n");
  EXPECT_EQ(Limits().memory_bytes, 7000);
  EXPECT_EQ(Limits().cores, 3);
}

TEST_F(ControlGroup, OfVersion1InAContainerIsWhereTheMachinesPathIsNot) {
  Write("/proc/self/cgroup", "9:memory:/parent/container\n4:cpu,cpuacct:/parent/container\n0::/\n");
  Write("/sys/fs/cgroup/memory/memory.limit_in_bytes", "5000\n");
  Write("/sys/fs/cgroup/cpu/cpu.cfs_quota_us", "50000\n");
  Write("/sys/fs/cgroup/cpu/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(Limits().memory_bytes, 5000);
  EXPECT_EQ(Limits().cores, 1);
}

TEST_F(ControlGroup, OfVersion1MayBeNested) {
  Write("/proc/self/cgroup", "9:memory:/slurm/job_7\n4:cpuacct,cpu:/slurm/job_7\n");
  Write("/sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");
  Write("/sys/fs/cgroup/memory/slurm/job_7/memory.limit_in_bytes", "6000\n");
  Write("/sys/fs/cgroup/cpu/cpu.cfs_quota_us", "-1\n");
  Write("/sys/fs/cgroup/cpu/cpu.cfs_period_us", "100000\n");
  Write("/sys/fs/cgroup/cpu/slurm/job_7/cpu.cfs_quota_us", "800000\n");
  Write("/sys/fs/cgroup/cpu/slurm/job_7/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(Limits().memory_bytes, 6000);
  EXPECT_EQ(Limits().cores, 8);
}

}  // namespace
}  // namespace latvox
