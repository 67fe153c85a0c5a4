// Compares the band on the Cartesian lattice with OpenVDB's meshToVolume of the same mesh.
#include <gtest/gtest.h>
#include <openvdb/tools/MeshToVolume.h>

#include <cmath>
#include <vector>

#include "client/grid/openvdb_trees.h"
#include "core/snap/snap.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/fields.h"
#include "tests/unit/core/sphere.h"

namespace latvox {
namespace {

constexpr float kWidth = 3;

// Leaves out the smoothing of values, so that they stay distances.
openvdb::FloatGrid::Ptr LevelSetOf(const TriangleMesh& mesh) {
  openvdb::initialize();
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const Vec3f& p : mesh.vertices) points.emplace_back(p[0], p[1], p[2]);
  for (const auto& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(points, triangles);
  return openvdb::tools::meshToVolume<openvdb::FloatGrid>(adapter, openvdb::math::Transform(), kWidth, kWidth,
                                                          openvdb::tools::DISABLE_RENORMALIZATION);
}

openvdb::FloatGrid::Ptr BandOf(const TriangleMesh& mesh) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const Result result =
      Voxelize(mesh, grid, {.set = Band{.width = kWidth}, .fields = {Field::kDistance}, .signed_distance = true});
  auto out = openvdb::FloatGrid::create(kWidth);
  for (const auto& [ijk, distance] : DistancesOf(result.tiles)) {
    out->tree().setValueOn({ijk[0], ijk[1], ijk[2]}, distance);
  }
  return out;
}

TEST(SignedBand, IsOpenVdbsNarrowBandOnCubes) {
  const TriangleMesh mesh = Sphere(24, 40);
  const auto ours = BandOf(mesh), theirs = LevelSetOf(mesh);
  // The effect of snapping, in voxels, and of the rounding of floats.
  constexpr double kSlack = kSnapErrorMax * 2 + 1e-3;
  // Away from the surface, OpenVDB only considers the triangles that a voxel's neighbors found nearest. So a few of its
  // distances are too long, or exceed the width; none is too short. Next to the surface, it puts a few voxels on the
  // wrong side.
  ASSERT_GT(ours->activeVoxelCount(), 50000U);
  size_t theirs_off = 0;
  for (auto value = ours->cbeginValueOn(); value; ++value) {
    const openvdb::Coord ijk = value.getCoord();
    const double distance = std::abs(*value), other = theirs->tree().getValue(ijk);
    ASSERT_LT(distance, std::abs(other) + kSlack) << ijk;
    theirs_off += (*value < 0) != (other < 0) || distance < std::abs(other) - kSlack;
  }
  EXPECT_LT(theirs_off, ours->activeVoxelCount() / 50);
  for (auto value = theirs->cbeginValueOn(); value; ++value) {
    if (!ours->tree().isValueOn(value.getCoord())) {
      ASSERT_GT(std::abs(*value), kWidth - kSlack) << value.getCoord();
    }
  }
}

}  // namespace
}  // namespace latvox
