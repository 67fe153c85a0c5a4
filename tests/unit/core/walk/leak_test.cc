// Holes that a walk passes, and the way that it tells.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <utility>

#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/walk/answers.h"
#include "tests/unit/core/walk/flood.h"

namespace latvox {
namespace {

// A box of 8 steps a side. One face has a square hole of the given width, in units, around the line through the middle.
oracle::Mesh BoxWithHole(int64_t width) {
  const int64_t low = 100, high = low + 8 * 256, first = low + 1024 - width / 2, last = first + width;
  oracle::Mesh mesh = Box({low, low, low}, {high, high, high});
  mesh.erase(mesh.begin(), mesh.begin() + 2);  // the face -k
  const auto add = [&](int64_t i0, int64_t j0, int64_t i1, int64_t j1) {
    mesh.push_back({Int3{i0, j0, low}, Int3{i1, j1, low}, Int3{i1, j0, low}});
    mesh.push_back({Int3{i0, j0, low}, Int3{i0, j1, low}, Int3{i1, j1, low}});
  };
  add(low, low, high, first);
  add(low, last, high, high);
  add(low, first, first, last);
  add(last, first, high, last);
  return mesh;
}

// The line of points through the middle of the hole is 1124 units from 0, between the points 4 and 5.
TEST(Walk, PassesAHoleOneStepWideAndNoNarrowerOne) {
  for (const int64_t k : {0, 2}) {
    const Connected inside{.seed = {4, 4, 4}, .close = 0, .allow_outside = false};
    for (const auto& [width, leaks] : {std::pair<int64_t, bool>{180, false}, {1600, true}}) {
      const TriangleMesh mesh = ToWorld(BoxWithHole(width), Cartesian());
      const Answer region = AnswerTo(mesh, Cartesian(), {.separability = k, .set = inside}, {});
      EXPECT_EQ(region.status.ok(), !leaks) << region.status;
      const Answer enclosed = AnswerTo(mesh, Cartesian(), {.separability = k, .set = Enclosed{}}, {});
      EXPECT_EQ(enclosed.facts->cavities, leaks ? 0U : 1U);
    }
  }
}

TEST(Walk, ExplainsALeak) {
  const TriangleMesh mesh = ToWorld(BoxWithHole(900), Cartesian(), {70, 70, 70});
  const Vec3d inside{74, 75, 74};
  const Answer leaky = AnswerTo(mesh, Cartesian(), {.set = Enclosed{.leak_from = inside}}, {});
  ASSERT_TRUE(leaky.status.ok() && leaky.facts && leaky.facts->leak) << leaky.status;
  const Leak& leak = *leaky.facts->leak;
  ASSERT_EQ(leak.kind, Leak::kFound);
  EXPECT_EQ(leak.from, (Vec3i{74, 75, 74}));
  EXPECT_EQ(leak.path.front(), leak.from);
  EXPECT_EQ(leak.steps + 1, leak.path.size());
  const Points walls = VoxelsOf(Voxelize(mesh, Unscaled(Cartesian()), {}));
  for (size_t n = 0; n < leak.path.size(); ++n) {
    EXPECT_FALSE(walls.contains(ToOracle(leak.path[n])));
    if (n == 0) continue;
    const Vec3i step = leak.path[n] - leak.path[n - 1];
    EXPECT_EQ(std::max({std::abs(step[0]), std::abs(step[1]), std::abs(step[2])}), 1);
  }
  // It leads through the middle of the hole, which is at 74.39 along i and j and at 70.39 along k.
  EXPECT_NEAR(leak.narrowest_world[0], 74.39, 1);
  EXPECT_NEAR(leak.narrowest_world[1], 74.39, 1);
  EXPECT_NEAR(leak.narrowest_world[2], 70.39, 1);
  EXPECT_GT(leak.room, 1);
  EXPECT_LT(leak.room, 1.77);
  // Twice that room closes it.
  const Answer closed = AnswerTo(mesh, Cartesian(), {.set = Enclosed{.close = 3.6, .leak_from = inside}}, {});
  ASSERT_TRUE(closed.facts && closed.facts->leak);
  EXPECT_EQ(closed.facts->leak->kind, Leak::kNone);
  EXPECT_EQ(closed.facts->cavities, 1U);
  const Connected seed{.seed = inside, .close = 0, .allow_outside = false};
  const Answer region = AnswerTo(mesh, Cartesian(), {.set = seed}, {});
  EXPECT_NE(region.status.message().find("through an opening around"), std::string::npos) << region.status;
}

TEST(Walk, RefusesASeedInTheSurface) {
  const TriangleMesh mesh = ToWorld(BoxWithHole(2), Cartesian());
  const Connected at_wall{.seed = {4.1, 4, 0.2}, .close = 0, .allow_outside = false};
  const Answer answer = AnswerTo(mesh, Cartesian(), {.set = at_wall}, {});
  EXPECT_EQ(answer.status.message(), "connected.seed: the nearest lattice point, 4,4,0, lies in the surface");
  const Answer leak = AnswerTo(mesh, Cartesian(), {.set = Enclosed{.leak_from = Vec3d{4.1, 4, 0.2}}}, {});
  ASSERT_TRUE(leak.facts && leak.facts->leak);
  EXPECT_EQ(leak.facts->leak->kind, Leak::kInWall);
}

}  // namespace
}  // namespace latvox
