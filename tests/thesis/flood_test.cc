// The flood by rows of bits equals the thesis's flood: breadth first, point by point (section 5.1).
#include <gtest/gtest.h>

#include <cstdio>
#include <random>
#include <set>

#include "core/lattice/lattice.h"
#include "core/verify/bcc_indexing.h"
#include "core/verify/water.h"

namespace latvox {
namespace {

Vec3i ToLattice(Numbering numbering, const Vec3i& number) {
  return numbering == Numbering::kBcc ? BccToLattice(number) : number;
}

std::set<Vec3i> PaddedPoints(const Volume& volume) {
  std::set<Vec3i> points;
  const Vec3i& size = volume.size;
  for (int32_t x = -kVolumeMargin; x < size[0] + kVolumeMargin; ++x) {
    for (int32_t y = -kVolumeMargin; y < size[1] + kVolumeMargin; ++y) {
      for (int32_t z = -kVolumeMargin; z < size[2] + kVolumeMargin; ++z) {
        points.insert(ToLattice(volume.numbering, {x, y, z}));
      }
    }
  }
  return points;
}

std::set<Vec3i> WaterBreadthFirst(const Volume& volume, const std::set<Vec3i>& points, const VoxelSet& surface,
                                  const std::vector<Frame>& frames) {
  std::set<Vec3i> water;
  std::vector<Vec3i> shore, next;
  const auto pour = [&](const Vec3i& ijk) {
    if (points.contains(ijk) && !surface.Contains(ijk) && water.insert(ijk).second) next.push_back(ijk);
  };
  pour(ToLattice(volume.numbering, {-kVolumeMargin, -kVolumeMargin, -kVolumeMargin}));
  while (!next.empty()) {
    shore.swap(next);
    next.clear();
    for (const Vec3i& ijk : shore) {
      for (const Frame& frame : frames) {
        pour(ijk + frame.q);
        pour(ijk - frame.q);
      }
    }
  }
  return water;
}

// Surfaces that are dense enough for caves, near the density at which water stops passing through.
TEST(Flood, EqualsBreadthFirstSearchInMazes) {
  constexpr unsigned kSeed = 4;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  uint64_t wet = 0, dry = 0;
  for (const NamedLattice name :
       {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc, NamedLattice::kHexagonal}) {
    const Lattice lattice = Lattice::Named(name);
    const Numbering numbering = name == NamedLattice::kBcc ? Numbering::kBcc : Numbering::kLattice;
    // Rows of one word, of several whole words, and of words in part.
    for (const Vec3i& size : {Vec3i{5, 6, 7}, Vec3i{5, 4, 60}, Vec3i{4, 5, 90}, Vec3i{3, 3, 124}}) {
      const Volume volume{numbering, size};
      const std::set<Vec3i> points = PaddedPoints(volume);
      for (int run = 0; run < 30; ++run) {
        const auto& frames = lattice.frames(run % 3);
        const double density = 0.3 + 0.02 * run;
        VoxelSet surface;
        for (const Vec3i& point : points) {
          if (static_cast<double>(random()) < density * 4294967296.0) surface.Insert(point);
        }
        const std::set<Vec3i> water = WaterBreadthFirst(volume, points, surface, frames);
        const Flood flood(volume, surface, frames);
        ASSERT_EQ(flood.water(), water.size()) << lattice.name() << " run " << run;
        ASSERT_EQ(flood.surface(), surface.size());
        ASSERT_EQ(flood.inside(), points.size() - water.size() - surface.size());
        for (const Vec3i& point : points) {
          ASSERT_EQ(flood.At(point) == Label::kWater, water.contains(point));
          ASSERT_EQ(flood.At(point) == Label::kSurface, surface.Contains(point));
        }
        wet += water.size();
        dry += flood.inside();
      }
    }
  }
  EXPECT_GT(wet, 0U);
  EXPECT_GT(dry, 0U);
}

}  // namespace
}  // namespace latvox
