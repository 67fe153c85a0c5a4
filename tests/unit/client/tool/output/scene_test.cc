#include <gmock/gmock.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "client/internal/vec3.h"
#include "client/tool/output/beam.h"
#include "client/tool/output/depth_blur.h"
#include "client/tool/output/hollows.h"
#include "client/tool/output/picture.h"
#include "client/tool/output/share.h"
#include "client/tool/output/voronoi_cell.h"
#include "client/tool/output/voxel_front.h"
#include "client/tool/output/voxel_scene.h"

namespace latvox::client {
namespace {

const Basis kLattices[] = {
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},                    // cubes
    {{2, 0, 0}, {0, 2, 0}, {1, 1, 1}},                    // BCC
    {{1, 1, 0}, {1, 0, 1}, {0, 1, 1}},                    // FCC
    {{1, 0, 0}, {0.5, std::sqrt(0.75), 0}, {0, 0, 1.1}},  // hexagonal
    {{0.3, 0.01, -0.02}, {0.05, 0.4, 0.03}, {-0.1, 0.07, 0.5}},
    {{1, 0, 0}, {3, 1, 0}, {2, 2, 1}},  // cubes again, in a skewed basis
};

// from + t * along, 0 <= t <= reach.
struct Ray {
  Vec3d from, along;
  double reach;
};

// Scattered voxels, so that rays skip empty bricks and tiles.
std::vector<Brick> Scattered(std::mt19937& chance, int bricks) {
  std::vector<Brick> out;
  for (int n = 0; n < bricks; ++n) {
    const auto place = [&] { return static_cast<int32_t>(chance() % 24) - 9; };
    Brick brick{{place(), place(), place()}, {}};
    for (int voxel = 0; voxel < 6; ++voxel) brick.mask[chance() % 8] |= uint64_t{1} << (chance() % 64);
    out.push_back(brick);
  }
  return out;
}

template <class Visit>
void ForEachCell(const VoxelScene& scene, const Visit& visit) {
  scene.ForEachBrick([&](const Brick& brick) { ForEachVoxel(brick, visit); });
}

// Returns where the ray enters the nearest cell, by cutting it with every facet of every cell.
std::optional<double> NearestByBruteForce(const VoxelScene& scene, const VoronoiCell& cell, const Basis& basis,
                                          const Ray& ray) {
  std::optional<double> nearest;
  ForEachCell(scene, [&](const Vec3i& at) {
    const Vec3d center = scene.CenterOf(at);
    double in = 0, out = ray.reach;
    for (const CellFace& face : cell.faces) {
      const Vec3i& f = face.neighbor;
      const Vec3d w = Combine(basis, {double(f[0]), double(f[1]), double(f[2])});
      const double room = Dot(w, w) / 2 - Dot(Sum(ray.from, -1, center), w), along = Dot(ray.along, w);
      if (along > 0) out = std::min(out, room / along);
      if (along < 0) in = std::max(in, room / along);
      if (along == 0 && room < 0) out = -1;
    }
    if (in <= out && (!nearest || in < *nearest)) nearest = in;
  });
  return nearest;
}

TEST(VoxelScene, RaysMeetTheCellThatBruteForceFinds) {
  std::mt19937 chance(20260719);
  std::normal_distribution<double> normal;
  int hits = 0, misses = 0;
  for (const Basis& lattice : kLattices) {
    const double size = std::cbrt(std::abs(Dot(lattice.a, Cross(lattice.b, lattice.c))));
    const Basis unit = {Sum({}, 1 / size, lattice.a), Sum({}, 1 / size, lattice.b), Sum({}, 1 / size, lattice.c)};
    const VoronoiCell cell = VoronoiCellOf(unit);
    VoxelScene scene({lattice, {100, -200, 300}, size}, 0);
    for (const Brick& brick : Scattered(chance, 40)) scene.Add(brick);
    std::vector<Vec3i> cells;
    ForEachCell(scene, [&](const Vec3i& at) { cells.push_back(at); });
    for (const bool sealed : {false, true}) {
      if (sealed) scene.Seal();
      for (int n = 0; n < 150; ++n) {
        Vec3d direction = Unit({normal(chance), normal(chance), normal(chance)});
        if (n % 5 == 0) {  // along an axis, exactly or nearly: most of these rays pass beside the box
          direction = {n % 2 == 0 ? 0 : 1e-17, 0, 0};
          direction[static_cast<size_t>(n / 5 % 3)] = n % 4 < 2 ? 1 : -1;
        }
        const Vec3d near = Sum(scene.CenterOf(cells[chance() % cells.size()]), 1.2,
                               {normal(chance), normal(chance), n % 5 == 0 ? normal(chance) : 0});
        const double before = n % 3 == 0 ? 5 : 300, reach = n % 4 == 0 ? before + 1 : 1e6;
        const Ray ray{Sum(near, -before, direction), direction, reach};
        const auto expected = NearestByBruteForce(scene, cell, unit, ray);
        VoxelScene::Beam beam(scene, direction);
        beam.Cast(Sum(ray.from, 100, ray.along));  // a beam that has been elsewhere finds the same
        const auto hit = beam.Cast(ray.from, ray.reach);
        ASSERT_EQ(hit.has_value(), expected.has_value()) << "ray " << n;
        hit ? ++hits : ++misses;
        if (!hit) continue;
        ASSERT_NEAR(hit->t, *expected, 1e-7) << "ray " << n;
        EXPECT_TRUE(scene.Has(hit->cell));
        if (hit->t == 0) continue;
        const VoxelScene::Facet& facet = scene.facets()[static_cast<size_t>(hit->facet)];
        const Vec3d at = Sum(Sum(ray.from, hit->t, ray.along), -1, scene.CenterOf(hit->cell));
        EXPECT_NEAR(Dot(at, facet.normal), facet.distance, 1e-7) << "the point is not on the facet";
        EXPECT_LT(Dot(ray.along, facet.normal), 0);
      }
    }
  }
  EXPECT_GT(hits, 300);
  EXPECT_GT(misses, 300);
}

TEST(VoxelScene, ShiftedCellsAreThoseThatHoldAVoxel) {
  std::mt19937 chance(7);
  const std::vector<Brick> bricks = Scattered(chance, 30);
  for (int shift = 0; shift < 6; ++shift) {
    VoxelScene scene({kLattices[1], {}, 0}, shift);
    std::set<Vec3i> expected, found;
    const auto corner = [&](int32_t ijk) { return (ijk >> shift) & ~63; };
    for (const Brick& brick : bricks) {
      scene.Add(brick);
      const Vec3i& first = bricks[0].brick_ijk;
      ForEachVoxel(brick, [&](const Vec3i& ijk) {
        Vec3i cell;
        for (size_t m = 0; m < 3; ++m) cell[m] = (ijk[m] >> shift) - corner(first[m] * 8);
        expected.insert(cell);
      });
    }
    ForEachCell(scene, [&](const Vec3i& cell) { found.insert(cell); });
    EXPECT_EQ(found, expected) << "shift " << shift;
    EXPECT_NEAR(scene.cell_size(), std::cbrt(4) * (1 << shift), 1e-9);
  }
}

// A cell has the color of one of its voxels, the same in any order of bricks. Without a shift it has only one voxel.
TEST(VoxelScene, CellsHaveTheColorsOfTheirVoxels) {
  std::mt19937 chance(13);
  std::vector<Brick> bricks = Scattered(chance, 30);
  const auto color_of = [](const Vec3i& ijk) {
    return static_cast<uint32_t>(ijk[0] * 7 + ijk[1] * 5 + ijk[2]) & 0xFFFFFF;
  };
  for (int shift = 0; shift < 5; ++shift) {
    VoxelScene one({kLattices[0], {}, 0}, shift), other = one;
    std::map<Vec3i, std::set<uint32_t>> expected;
    const auto add = [&](const Brick& brick, VoxelScene& scene) {
      std::vector<uint32_t> colors;
      ForEachVoxel(brick, [&](const Vec3i& ijk) {
        Vec3i cell;
        for (size_t m = 0; m < 3; ++m) cell[m] = (ijk[m] >> shift) - ((bricks[0].brick_ijk[m] * 8 >> shift) & ~63);
        expected[cell].insert(color_of(ijk));
        colors.push_back(color_of(ijk));
      });
      scene.Add(brick, colors);
    };
    add(bricks[0], one);  // the first brick decides the position of cell 0
    add(bricks[0], other);
    for (size_t n = 0; n < bricks.size(); ++n) {
      add(bricks[n], one);
      add(bricks[bricks.size() - 1 - n], other);
    }
    size_t cells = 0;
    ForEachCell(one, [&](const Vec3i& cell) {
      ++cells;
      EXPECT_TRUE(expected[cell].contains(one.ColorOf(cell))) << "shift " << shift;
      EXPECT_EQ(one.ColorOf(cell), other.ColorOf(cell));
    });
    EXPECT_EQ(cells, expected.size());
  }
}

// Cubes of full bricks around the corners of tiles, 5 bricks long, except for the last voxel of the second brick of a
// row.
std::vector<Brick> Solid() {
  std::vector<Brick> out;
  for (int32_t n = 0; n < 125; ++n) {
    Brick& brick = out.emplace_back(Brick{{n / 25 - 2, n / 5 % 5 - 2, n % 5 - 2}, {}});
    brick.mask.fill(~uint64_t{0});
  }
  out[1].mask[7] >>= 1;
  return out;
}

TEST(VoxelScene, CellsThatAreNotDeepInsideAreOuter) {
  VoxelScene scene({kLattices[1], {}, 0}, 0);
  for (const Brick& brick : Solid()) scene.Add(brick);
  scene.Seal();
  std::set<Vec3i> deep;
  ForEachCell(scene, [&](const Vec3i& cell) { deep.insert(cell); });
  EXPECT_EQ(deep.size(), 125 * 512 - 1U);
  scene.ForEachOuterBrick(
      [&](const Brick& brick) { ForEachVoxel(brick, [&](const Vec3i& cell) { EXPECT_EQ(deep.erase(cell), 1U); }); });
  // Bricks inside the outermost layer, except the two that touch the brick that is not full.
  EXPECT_EQ(deep.size(), (27 - 2) * 512U);
}

// Bricks next to each other: full ones, ones with holes, and thin ones.
std::vector<Brick> Mixed(std::mt19937& chance) {
  std::vector<Brick> out;
  for (int32_t n = 0; n < 27; ++n) {
    Brick& brick = out.emplace_back(Brick{{n / 9, n / 3 % 3, n % 3}, {}});
    const unsigned kind = chance() % 4;
    for (uint64_t& word : brick.mask) {
      const auto random = [&chance] { return uint64_t{chance()} << 32 | chance(); };
      const uint64_t holes = random() & random() & random() & random() & random();
      word = kind == 0 ? holes : kind == 1 ? ~holes : ~uint64_t{0};
    }
  }
  return out;
}

TEST(VoxelScene, CellsWithoutAFreeFacetAreNotInTheShell) {
  std::mt19937 chance(23);
  size_t shown = 0, hidden = 0;
  for (const Basis& lattice : kLattices) {
    VoxelScene scene({lattice, {}, 0}, 0);
    for (const Brick& brick : Mixed(chance)) scene.Add(brick);
    scene.ForEachBrick([&](const Brick& brick) {
      const Brick shell = scene.ShellOf(brick);
      EXPECT_EQ(shell.brick_ijk, brick.brick_ijk);
      std::set<Vec3i> cells;
      ForEachVoxel(shell, [&](const Vec3i& cell) { cells.insert(cell); });
      ForEachVoxel(brick, [&](const Vec3i& cell) {
        const bool free = std::ranges::any_of(scene.facets(), [&](const VoxelScene::Facet& facet) {
          return !scene.Has({cell[0] + facet.step[0], cell[1] + facet.step[1], cell[2] + facet.step[2]});
        });
        ASSERT_EQ(cells.erase(cell), free ? 1U : 0U);
        ++(free ? shown : hidden);
      });
      EXPECT_TRUE(cells.empty()) << "cells that the brick does not have";
    });
  }
  EXPECT_GT(shown, 5000U);
  EXPECT_GT(hidden, 5000U);
}

TEST(VoxelFront, NoVoxelIsBeyondIt) {
  std::mt19937 chance(11);
  std::normal_distribution<double> normal;
  size_t n = 0;
  for (const Basis& lattice : kLattices) {
    VoxelScene scene({lattice, {}, 0}, 0);
    const size_t kind = n++ % 3;
    for (const Brick& brick : kind == 0 ? Scattered(chance, 10) : kind == 1 ? Solid() : Mixed(chance)) scene.Add(brick);
    scene.Seal();
    const Vec3d towards = Unit({normal(chance), normal(chance), normal(chance)});
    for (const double square : {1, 2}) {
      const VoxelFront::View view{towards, square};
      const VoxelFront front = VoxelFront::Of(scene, {&view, 1}).front();
      double least = 1e9;
      ForEachCell(scene, [&](const Vec3i& cell) {
        for (const Vec3d& corner : scene.cell_corners()) {
          const double reach = front.Reach(Sum(scene.CenterOf(cell), 1, corner));
          EXPECT_GE(reach, 0);
          least = std::min(least, reach);
        }
      });
      EXPECT_LT(least, 5) << "a bound, but an idle one";
      const Vec3d aside = Cross(towards, Unit({1, 2, 3}));
      EXPECT_EQ(front.Reach(Sum({}, 1e4, aside)), -std::numeric_limits<double>::infinity());
    }
  }
}

TEST(Picture, BytesAreTheSameForAnyNumberOfThreads) {
  std::mt19937 chance(3);
  VoxelScene scene({kLattices[2], {}, 0}, 0);
  for (const Brick& brick : Scattered(chance, 60)) scene.Add(brick);
  scene.Seal();
  const PictureOptions options{.side = 150};
  const auto draw = [&](size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const auto png = DrawVoxels(scene, options);
    EXPECT_TRUE(png.ok()) << png.status();
    return *png;
  };
  const std::string one = draw(1);
  EXPECT_EQ(draw(3), one);
  PictureOptions other = options;
  other.azimuth += 5;
  EXPECT_NE(*DrawVoxels(scene, other), one);
  other = options;
  other.color[0] = 0;
  EXPECT_NE(*DrawVoxels(scene, other), one);
}

TEST(Picture, WithoutAVoxelThereIsBackground) {
  VoxelScene scene({kLattices[0], {}, 0}, 0);
  scene.Seal();
  EXPECT_TRUE(DrawVoxels(scene, {.side = 32}).ok());
}

TEST(Picture, ScenesHoldNoMoreThanThePictureTells) {
  const GridTransform grid = {kLattices[0], {}, 1};
  EXPECT_EQ(ShiftFor(grid, 100, {}), 0);
  const int shift = ShiftFor(grid, 60000, {});
  EXPECT_GE(shift, 3);
  EXPECT_LE(shift, 5);
  EXPECT_EQ(ShiftFor(grid, 60000, {.side = 2048}), shift - 1);
}

// Compares with the definition, ring by ring, also where the surroundings rise beyond the reach or end.
TEST(Hollows, HideWhatTheSteepestRiseHides) {
  constexpr int kWide = 64;
  constexpr float kReach = 0.07F * kWide;
  constexpr std::array<float, 3> kUp = {0, 0, 1}, kOblique = {0.4F, -0.3F, 0.87F}, kSteep = {0.9F, 0.1F, 0.4F};
  std::mt19937 chance(17);
  int dark = 0;
  for (const auto& [roughness, normal] : {std::pair(1.0F, kUp), {8.0F, kUp}, {2.0F, kOblique}, {8.0F, kSteep}}) {
    std::vector<float> depth(kWide * kWide);
    for (float& each : depth) {
      each = chance() % 8 == 0 ? kNoDepth : roughness * static_cast<float>(chance() % 1000) / 500;
    }
    const Hollows hollows(kWide);
    for (int n = 0; n < kWide * kWide; n += 7) {
      const int x = n % kWide, y = n / kWide;
      const float here = depth[static_cast<size_t>(n)];
      if (here == kNoDepth) continue;
      float sum = 0;
      for (int d = 0; d < 8; ++d) {
        const float angle =
            (static_cast<float>(d) + static_cast<float>(x % 2 + 2 * (y % 2)) / 4) * std::numbers::pi_v<float> / 4;
        float hidden = 0, distance = kReach;
        for (int ring = 0; ring < 5; ++ring, distance *= 0.55F) {
          const int dx = static_cast<int>(std::lround(std::cos(angle) * distance));
          const int dy = static_cast<int>(std::lround(std::sin(angle) * distance));
          if (std::min(x + dx, y + dy) < 0 || std::max(x + dx, y + dy) >= kWide) continue;
          const float plane = (normal[0] * static_cast<float>(dx) - normal[1] * static_cast<float>(dy)) / normal[2];
          const float rise = depth[static_cast<size_t>(n + dy * kWide + dx)] - here + plane;
          if (!(rise > 0)) continue;
          const float sine = rise / std::hypot(rise, distance);
          hidden = std::max(hidden, ShareOf(sine, 0.08F, 1) * ShareOf(rise, 3 * kReach, kReach));
        }
        sum += hidden;
      }
      ASSERT_NEAR(hollows.Share(depth, x, y, normal), sum / 8 * ShareOf(normal[2], 0.1F, 0.5F), 1e-5) << x << " " << y;
      dark += sum > 2;
    }
  }
  EXPECT_GT(dark, 50);
}

// Compares with the sums of the definition, where windows cover empty samples, steps and edges of the picture.
TEST(SmoothDepth, AveragesWhatIsNearInDepth) {
  constexpr int kWide = 61;
  std::mt19937 chance(7);
  for (const int radius : {2, 5, 32}) {
    std::vector<float> depth(kWide * kWide, kNoDepth);
    for (size_t n = 0; n < depth.size(); ++n) {
      const auto x = static_cast<float>(n % kWide), y = static_cast<float>(n / kWide);
      if (std::hypot(x - 28, y - 33) < 27) depth[n] = y / 3 + static_cast<float>(chance() % 5) - (x > 30 ? 70.F : 0.F);
    }
    std::vector<float> expected = depth;
    for (const int step : {1, kWide, 1, kWide}) {
      const std::vector<float> in = expected;
      for (int n = 0; n < kWide * kWide; ++n) {
        const int along = step == 1 ? n % kWide : n / kWide;
        const float here = in[static_cast<size_t>(n)];
        double sum = 0, count = 0;
        for (int d = std::max(-radius, -along); d <= std::min(radius, kWide - 1 - along); ++d) {
          const float there = in[static_cast<size_t>(n + d * step)];
          if (!(std::abs(there - here) < 3.0F * static_cast<float>(radius))) continue;
          sum += there;
          ++count;
        }
        if (here != kNoDepth) expected[static_cast<size_t>(n)] = static_cast<float>(sum / count);
      }
    }
    const std::vector<float> found = SmoothDepth(depth, kWide, radius);
    for (size_t n = 0; n < found.size(); ++n) {
      if (expected[n] == kNoDepth) {
        ASSERT_EQ(found[n], kNoDepth);
      } else {
        ASSERT_NEAR(found[n], expected[n], 1e-3) << radius << " " << n;
      }
    }
  }
}

}  // namespace
}  // namespace latvox::client
