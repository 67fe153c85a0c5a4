// The resolution that --dims decides on is the greatest that fits, and few trials find it.
#include "client/tool/cli/dims_resolution.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace latvox::client {
namespace {

using testing::HasSubstr;

// Voxels of a mesh: a side has so many steps for each voxel of resolution, and a margin for the set.
struct Model {
  std::array<double, 3> steps;
  int margin = 0;

  IndexBox At(uint32_t resolution) const {
    IndexBox box{};
    for (size_t m = 0; m < 3; ++m) {
      box.min[m] = -7;
      box.max[m] = -6 + static_cast<int32_t>(std::floor(resolution * steps[m])) + margin;
    }
    return box;
  }
};

TEST(DimsResolution, IsTheGreatestThatFits) {
  for (const Model& model : {Model{{1, 1, 1}}, Model{{1, 1, 1}, 2}, Model{{0.79, 0.79, 1.58}, 1}, Model{{1, 0.1, 0}, 5},
                             Model{{1, 1, 1}, 20}, Model{{0.8, 0.3, 0.5}, 3}}) {
    for (const BoxShape& shape : {BoxShape{.dims = Vec3i{32, 32, 32}}, BoxShape{.pad = 2, .dims = Vec3i{31, 64, 40}},
                                  BoxShape{.dims = Vec3i{1000, 300, 200}}}) {
      const auto fits = [&](uint32_t resolution) { return ShapedBox(model.At(resolution), shape, "").ok(); };
      int trials = 0;
      const auto found = FindResolution(shape, [&](uint32_t resolution) {
        ++trials;
        return absl::StatusOr<std::optional<IndexBox>>(model.At(resolution));
      });
      ASSERT_TRUE(found.ok()) << found.status();
      EXPECT_TRUE(fits(*found) && !fits(*found + 1)) << *found;
      EXPECT_LE(trials, 6);
    }
  }
}

TEST(DimsResolution, TellsIfNoneFits) {
  const auto found = FindResolution({.dims = Vec3i{9, 9, 4}}, [](uint32_t resolution) {
    return absl::StatusOr<std::optional<IndexBox>>(Model{{1, 1, 1}, 3}.At(resolution));
  });
  EXPECT_EQ(found.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(found.status().message()),
              HasSubstr("at --resolution 2: --dims: 4 along k is less than the 6 points that the voxels take"));
}

TEST(DimsResolution, EndsWithoutVoxelsAndWithErrors) {
  const BoxShape shape = {.dims = Vec3i{9, 9, 9}};
  const auto none =
      FindResolution(shape, [](uint32_t) { return absl::StatusOr<std::optional<IndexBox>>(std::nullopt); });
  EXPECT_EQ(none.value_or(0), 9U);
  const auto error = FindResolution(
      shape, [](uint32_t) -> absl::StatusOr<std::optional<IndexBox>> { return absl::UnavailableError("gone"); });
  EXPECT_EQ(error.status(), absl::UnavailableError("gone"));
}

}  // namespace
}  // namespace latvox::client
