// The two shortcuts of the pipeline, compared with the plain scan in every direction.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "core/digitize/principal_scan.h"
#include "core/digitize/star.h"
#include "tests/unit/core/exact.h"

namespace latvox {
namespace {

constexpr int32_t kFar = 1 << 20;
constexpr IndexBox kEverywhere{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};
using Ends = std::pair<Vec3i, Vec3i>;  // nearer, farther

Triangle ToCore(const oracle::Triangle& triangle) {
  Triangle out;
  for (size_t n = 0; n < 3; ++n) {
    for (size_t m = 0; m < 3; ++m) out[n][m] = static_cast<int32_t>(triangle[n][m]);
  }
  return out;
}

std::set<Ends> CrossingsOf(const Triangle& triangle, const Frame& frame, const IndexBox& box) {
  std::set<Ends> crossings;
  ForEachCrossing(triangle, frame, box, [&](const Vec3i& nearer, const Vec3i& farther) {
    crossings.insert({nearer, farther});
  });
  return crossings;
}

// The result of a principal scan with stars: all nearer ends in the box.
std::set<Vec3i> PrincipalVoxels(const Triangle& triangle, const std::vector<ScanFrame>& frames, const IndexBox& box) {
  std::set<Vec3i> voxels;
  const OrientedTriangle oriented(triangle);
  if (oriented.normal == Vec<int64_t, 3>{}) return voxels;
  ScanAlongPrincipal(
      oriented, PrincipalScanFrame(frames, oriented.normal), box,
      [&](const Vec3i& nearer, const Vec3i&) { voxels.insert(nearer); },
      [&](const Vec3i& z) {
        const Star star(oriented, z);
        Vec3i step;
        for (const ScanFrame& scan : frames) {
          if (star.IsNearerEnd(scan.frame.q, step)) voxels.insert(z);
        }
      });
  return voxels;
}

void ExpectSameVoxels(const Triangle& triangle, const std::vector<Frame>& frames, const IndexBox& box,
                      const std::string& where) {
  std::set<Vec3i> expected;
  for (const Frame& frame : frames) {
    for (const auto& [nearer, farther] : CrossingsOf(triangle, frame, box)) expected.insert(nearer);
  }
  ASSERT_EQ(PrincipalVoxels(triangle, MakeScanFrames(frames), box), expected) << where;
}

TEST(PrincipalScan, FindsTheVoxelsOfEveryDirectionOnAdversarialTriangles) {
  for (const ExactLattice& l : ExactLattices()) {
    for (int k : {0, 1, 2}) {
      const auto& frames = l.lattice.frames(k);
      for (const auto& mesh : oracle::AdversarialMeshes(31, Directions(frames))) {
        if (mesh.box) continue;
        for (const auto& triangle : mesh.triangles) {
          ExpectSameVoxels(ToCore(triangle), frames, kEverywhere, l.name + " " + mesh.name);
        }
      }
    }
  }
}

TEST(PrincipalScan, FindsTheVoxelsOfEveryDirectionAtTheLimitsOfTheWidths) {
  constexpr unsigned kSeed = 17;
  std::mt19937 random(kSeed);
  constexpr int32_t kTop = kMaxExtent * kLatticeUnit;
  std::uniform_int_distribution<int32_t> coordinate(0, kTop);
  for (const ExactLattice& l : ExactLattices()) {
    for (int n = 0; n < 200; ++n) {
      Triangle triangle;
      for (auto& v : triangle) {
        for (auto& x : v) x = n % 2 == 0 ? coordinate(random) : coordinate(random) < kTop / 2 ? 0 : kTop;
      }
      IndexBox box;  // around a corner, where the rim is, or a point within
      for (size_t m = 0; m < 3; ++m) {
        const int64_t sum = int64_t{triangle[0][m]} + triangle[1][m] + 2 * int64_t{triangle[2][m]};
        const auto middle = static_cast<int32_t>(n % 3 == 0 ? triangle[0][m] / 256 : sum / 4 / 256);
        box.min[m] = middle - 4;
        box.max[m] = middle + 5;
      }
      ExpectSameVoxels(triangle, l.lattice.frames(0), box, l.name + " seed 17, triangle " + std::to_string(n));
    }
  }
}

TEST(Star, SaysOfEveryEdgeWhatTheCrossingRuleSays) {
  for (const ExactLattice& l : ExactLattices()) {
    const auto& frames = l.lattice.frames(0);
    for (const auto& mesh : oracle::AdversarialMeshes(32, Directions(frames))) {
      if (mesh.box || mesh.triangles.size() > 40) continue;
      for (const auto& t : mesh.triangles) {
        const Triangle triangle = ToCore(t);
        const OrientedTriangle oriented(triangle);
        for (const Frame& frame : frames) {
          const auto expected = CrossingsOf(triangle, frame, kEverywhere);
          std::set<Ends> found;
          for (const auto& [nearer, farther] : expected) {
            for (const Vec3i& z : {nearer, farther, nearer + frame.u[0], farther - frame.u[1]}) {
              const Star star(oriented, z);
              Vec3i step;
              if (star.IsNearerEnd(frame.q, step)) found.insert({z, z + step});
            }
          }
          ASSERT_EQ(found, expected) << l.name << " " << mesh.name;
        }
      }
    }
  }
}

TEST(ScanFrame, HullAttainsTheMaximumOverAllDirections) {
  constexpr unsigned kSeed = 4;
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<int64_t> entry(-50, 50);
  for (const ExactLattice& l : ExactLattices()) {
    for (int k : {0, 1, 2}) {
      const auto& frames = l.lattice.frames(k);
      for (const ScanFrame& scan : MakeScanFrames(frames)) {
        for (int n = 0; n < 200; ++n) {
          const Vec<int64_t, 2> g{entry(random), entry(random)};
          int64_t all = 0, hull = 0;
          for (const Frame& frame : frames) {
            const Vec<int64_t, 2> p{Dot(scan.frame.r[0], frame.q), Dot(scan.frame.r[1], frame.q)};
            all = std::max(all, std::abs(Dot(g, p)));
          }
          for (const auto& p : scan.hull) hull = std::max(hull, std::abs(Dot(g, p)));
          ASSERT_EQ(hull, all) << l.name << " k " << k;
        }
      }
    }
  }
}

}  // namespace
}  // namespace latvox
