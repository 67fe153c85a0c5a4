// The thesis's validation (chapter 5): water, minimality, and their results for its algorithms on its tetrahedron.
#include "core/verify/water.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "core/base/stop_signal.h"
#include "core/thesis/incremental.h"
#include "core/thesis/seams.h"
#include "core/verify/bcc_indexing.h"
#include "core/verify/minimality.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/thesis_meshes.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

// ---- BCC numbering --------------------------------------------------------------------------------------------------

TEST(BccIndexing, RoundTripsAndPlacesPointsAsFigure56) {
  for (int n = 0; n < 9261; ++n) {
    const Vec3i index{n / 441 - 10, n / 21 % 21 - 10, n % 21 - 10};
    EXPECT_EQ(LatticeToBcc(BccToLattice(index)), index);
    EXPECT_EQ(BccToLattice(LatticeToBcc(index)), index);
    const int32_t odd = index[2] & 1;
    const Mat<int32_t, 3> basis{{{2, 0, 0}, {0, 2, 0}, {1, 1, 1}}};
    EXPECT_EQ(Apply(basis, BccToLattice(index)), (Vec3i{2 * index[0] + odd, 2 * index[1] + odd, index[2]}));
  }
}

TEST(BccIndexing, FairResolutionsHaveEqualCountsAndInvertEachOther) {
  EXPECT_NEAR(FairBccResolution(100), 79.37, 0.01);   // the thesis: about 80
  EXPECT_NEAR(FairBccResolution(256), 203.19, 0.01);  // the thesis: 203 x 203 x 406
  for (double d : {10.0, 64.0, 200.0}) {
    EXPECT_NEAR(FairCartesianResolution(FairBccResolution(d)), d, 1e-9);
    EXPECT_NEAR(2 * std::pow(FairBccResolution(d), 3), d * d * d, 1e-6);
  }
}

// ---- Water ----------------------------------------------------------------------------------------------------------

// A lattice whose points in a world cube are a volume of the thesis's numbering.
struct Experiment {
  std::string name;
  Grid grid;
  int k;
  Volume volume;
  double side;  // of the cube, world
};

// Half a voxel from the cube's corner, so that no face of the tetrahedron lies in a lattice plane at 0 degrees.
std::vector<Experiment> Experiments(int32_t resolution) {
  std::vector<Experiment> experiments;
  const Lattice cartesian = ExactLattices()[0].lattice, bcc = ExactLattices()[1].lattice;
  const Vec3d origin{0.5, 0.5, 0.5};
  for (int k : {0, 1, 2}) {
    experiments.push_back({"cartesian " + std::to_string(k),
                           {cartesian, origin},
                           k,
                           {Numbering::kLattice, {resolution, resolution, resolution}},
                           static_cast<double>(resolution)});
  }
  const auto d = static_cast<int32_t>(std::lround(FairBccResolution(resolution)));
  experiments.push_back({"bcc", {bcc, origin}, 2, {Numbering::kBcc, {d, d, 2 * d}}, 2.0 * d});
  return experiments;
}

TEST(Flood, FillsAnEmptyVolumeAndNothingBehindAClosedBox) {
  for (const Experiment& experiment : Experiments(16)) {
    const auto& frames = experiment.grid.lattice.frames(experiment.k);
    const Flood empty(experiment.volume, {}, frames);
    const Vec3i& size = experiment.volume.size;
    EXPECT_EQ(empty.water(), static_cast<uint64_t>((size[0] + 4) * (size[1] + 4) * (size[2] + 4)));
    EXPECT_EQ(empty.inside() + empty.surface(), 0U);
    EXPECT_EQ(empty.DisplacedVolume(), 0);

    // All neighbors of one point close it in; any of them taken away lets the water in.
    const Vec3i index{5, 5, 6};
    const Vec3i middle = experiment.volume.numbering == Numbering::kBcc ? BccToLattice(index) : index;
    std::vector<Vec3i> shell;
    for (const Frame& frame : frames) {
      shell.push_back(middle + frame.q);
      shell.push_back(middle - frame.q);
    }
    for (size_t hole = 0; hole <= shell.size(); ++hole) {
      VoxelSet surface;
      for (size_t n = 0; n < shell.size(); ++n) {
        if (n != hole) surface.Insert(shell[n]);
      }
      const Flood flood(experiment.volume, surface, frames);
      EXPECT_EQ(flood.surface(), surface.size());
      EXPECT_EQ(flood.inside(), hole == shell.size() ? 1U : 0U) << experiment.name;
      EXPECT_EQ(flood.At(middle), hole == shell.size() ? Label::kInside : Label::kWater);
    }
    EXPECT_EQ(empty.At({-100, 0, 0}), std::nullopt);
  }
}

VoxelSet VoxelsBy(Algorithm algorithm, const TriangleMesh& mesh, const Experiment& experiment) {
  VoxelSet voxels;
  auto job = *VoxelizeJob::Create(mesh, experiment.grid, {.separability = experiment.k, .algorithm = algorithm});
  EXPECT_TRUE(job->Advance([&](TileBricks&& tile) {
                   for (const Brick& brick : tile.bricks) voxels.Add(brick);
                   return true;
                 })
                  .ok());
  return voxels;
}

TEST(Water, DisplacedVolumeOfTheExactTetrahedronConverges) {
  for (size_t which = 0; which < 4; ++which) {
    double last = 1;
    for (int32_t resolution : {12, 24, 48}) {
      const Experiment experiment = Experiments(resolution)[which];
      double error = 0;
      for (int degrees : {0, 20, 45, 75, 130, 200, 290}) {
        const VoxelSet voxels = VoxelsBy(Algorithm::kExact, RotatedTetrahedron(degrees, experiment.side), experiment);
        const Flood flood(experiment.volume, voxels, experiment.grid.lattice.frames(experiment.k));
        error = std::max(error, std::abs(flood.DisplacedVolume() - kTetrahedronVolume));
      }
      // Half of the surface voxels would be inside: about half the area, (3 + sqrt 3)/4 = 1.2 of the side's square,
      // times a thickness of up to sqrt 3 voxels.
      EXPECT_LT(error, 1.2 / resolution) << experiment.name;
      EXPECT_LT(error, last * 0.75) << experiment.name;
      last = error;
    }
  }
}

TEST(Water, TetrahedraByEveryAlgorithmAreWatertight) {
  for (int32_t resolution : {10, 33}) {
    for (const Experiment& experiment : Experiments(resolution)) {
      for (const auto& [algorithm, name] : kAlgorithms) {
        for (int degrees = 0; degrees < 360; degrees += 25) {
          const VoxelSet voxels = VoxelsBy(algorithm, RotatedTetrahedron(degrees, experiment.side), experiment);
          const Flood flood(experiment.volume, voxels, experiment.grid.lattice.frames(experiment.k));
          EXPECT_GT(flood.inside(), 0U) << experiment.name << " " << name << " resolution " << resolution << " at "
                                        << degrees;
        }
      }
    }
  }
}

// ---- The incremental algorithms with seams --------------------------------------------------------------------------

uint64_t TunnelsOf(const SnappedMesh& mesh, const Experiment& experiment, const VoxelSet& voxels) {
  return CountTunnels(mesh, experiment.grid.lattice.frames(experiment.k), voxels, StopSignal())->tunnels;
}

TEST(Incremental, HasNoTunnelInTheRoundedTetrahedronButSomeInTheGivenOne) {
  uint64_t in_given = 0;
  for (const Experiment& experiment : Experiments(24)) {
    for (int degrees = 0; degrees < 360; degrees += 15) {
      const TriangleMesh mesh = RotatedTetrahedron(degrees, experiment.side);
      const SnappedMesh snapped = *Snap(mesh, experiment.grid.lattice, experiment.grid.origin, {2, 2, 2});
      const VoxelSet voxels = VoxelsBy(Algorithm::kIncremental, mesh, experiment);
      EXPECT_EQ(TunnelsOf(Rounded(snapped, experiment.grid.lattice), experiment, voxels), 0U)
          << experiment.name << " at " << degrees;
      in_given += TunnelsOf(snapped, experiment, voxels);
    }
  }
  // Rounding moves faces by up to the covering radius, which is more than the slabs are thick.
  EXPECT_GT(in_given, 0U);
  std::printf("incremental: %zu tunnels in the tetrahedra as given, none in the rounded ones\n",
              static_cast<size_t>(in_given));
}

TEST(BruteForce, HasNoTunnelInTheTetrahedronAsGiven) {
  for (const Experiment& experiment : Experiments(24)) {
    for (int degrees = 0; degrees < 360; degrees += 15) {
      const TriangleMesh mesh = RotatedTetrahedron(degrees, experiment.side);
      const SnappedMesh snapped = *Snap(mesh, experiment.grid.lattice, experiment.grid.origin, {2, 2, 2});
      const VoxelSet voxels = VoxelsBy(Algorithm::kBruteForce, mesh, experiment);
      EXPECT_EQ(TunnelsOf(snapped, experiment, voxels), 0U) << experiment.name << " at " << degrees;
    }
  }
}

// The purpose of section 4.5: the triangles alone leak along their edges.
TEST(Seams, AreNeeded) {
  uint64_t tunnels = 0;
  for (const Experiment& experiment : Experiments(24)) {
    for (int degrees = 5; degrees < 360; degrees += 40) {
      const SnappedMesh snapped = *Snap(RotatedTetrahedron(degrees, experiment.side), experiment.grid.lattice,
                                        experiment.grid.origin, {2, 2, 2});
      const SnappedMesh rounded = Rounded(snapped, experiment.grid.lattice);
      VoxelSet voxels;
      for (const auto& [v0, v1, v2] : snapped.triangles) {
        const auto at = [&](uint32_t v) { return RoundedVertices(snapped, experiment.grid.lattice)[v]; };
        IncrementalTriangle({at(v0), at(v1), at(v2)}, experiment.grid.lattice.frames(experiment.k), StopSignal(),
                            [&](const Vec3i& z) { voxels.Insert(z + snapped.base_ijk); });
      }
      tunnels += TunnelsOf(rounded, experiment, voxels);
    }
  }
  EXPECT_GT(tunnels, 0U);
}

// The meshes include open surfaces, whose rims have no second triangle, duplicates, slivers and triangles without area.
TEST(Incremental, HasNoTunnelInRoundedAdversarialMeshesNorBruteForceInGivenOnes) {
  constexpr unsigned kSeed = 77;
  uint64_t optimized = 0;
  for (const ExactLattice& l : ExactLattices()) {
    for (int k : Dose<std::vector<int>>({0, 1, 2}, {0})) {
      if (k > 0 && l.lattice.frames(k).size() == l.lattice.frames(k - 1).size()) continue;
      for (const auto& mesh : oracle::AdversarialMeshes(kSeed, Directions(l.lattice.frames(k)))) {
        if (mesh.box) continue;  // far larger than the tested part
        const Experiment experiment{l.name, Unscaled(l.lattice), k, {}, 0};
        const TriangleMesh world = ToWorld(mesh.triangles, l.lattice);
        const SnappedMesh snapped = *Snap(world, l.lattice, {}, {2, 2, 2});
        const SnappedMesh rounded = Rounded(snapped, l.lattice);
        const auto tunnels = [&](const SnappedMesh& surface, Algorithm algorithm) {
          return TunnelsOf(surface, experiment, VoxelsBy(algorithm, world, experiment));
        };
        EXPECT_EQ(tunnels(rounded, Algorithm::kIncremental), 0U) << l.name << " k " << k << " " << mesh.name;
        EXPECT_EQ(tunnels(snapped, Algorithm::kBruteForce), 0U) << l.name << " k " << k << " " << mesh.name;
        optimized += tunnels(rounded, Algorithm::kOptimizedIncremental);
      }
    }
  }
  std::printf("optimized incremental: %zu tunnels in rounded adversarial meshes\n", static_cast<size_t>(optimized));
}

// ---- Minimality -----------------------------------------------------------------------------------------------------

// The tetrahedron's voxels by one of the incremental algorithms, with the planes they come from.
std::vector<PlaneVoxel> PlaneVoxels(const SnappedMesh& snapped, const Experiment& experiment, bool optimized) {
  const auto& frames = experiment.grid.lattice.frames(experiment.k);
  const std::vector<Vec3i> rounded = RoundedVertices(snapped, experiment.grid.lattice);
  std::set<std::pair<Vec3i, uint32_t>> listed;
  std::vector<PlaneVoxel> voxels;
  std::map<std::pair<Vec3i, Vec3i>, std::vector<uint32_t>> edges;
  std::vector<Vec<int64_t, 3>> normals;
  const auto add = [&](const Vec3i& z, uint32_t plane) {
    const Vec3i ijk = z + snapped.base_ijk;
    if (listed.emplace(ijk, plane).second) voxels.push_back({ijk, PrincipalFrame(frames, normals[plane]).q, plane});
  };
  for (uint32_t t = 0; t < snapped.triangles.size(); ++t) {
    const auto& [v0, v1, v2] = snapped.triangles[t];
    const VoxelTriangle triangle{rounded[v0], rounded[v1], rounded[v2]};
    normals.push_back(NormalOf(triangle));
    const auto emit = [&](const Vec3i& z) { add(z, t); };
    (optimized ? OptimizedIncrementalTriangle : IncrementalTriangle)(triangle, frames, StopSignal(), emit);
    for (size_t n = 0; n < 3; ++n) edges[std::minmax(triangle[n], triangle[(n + 1) % 3])].push_back(t);
  }
  const Neighborhood neighborhood(experiment.grid.lattice, experiment.k);
  for (const auto& entry : edges) {
    const auto& edge = entry.first;
    const auto& triangles = entry.second;
    std::vector<Vec<int64_t, 3>> both;
    for (uint32_t t : triangles) both.push_back(normals[t]);
    Seam(edge.first, edge.second, both, neighborhood, StopSignal(), [&](const Vec3i& z) {
      for (uint32_t t : triangles) add(z, t);
    });
  }
  return voxels;
}

TEST(Minimality, CountsARedundantVoxelThatNoExclusionExcuses) {
  const Experiment experiment = Experiments(20)[2];  // Cartesian, k = 2
  const auto& frames = experiment.grid.lattice.frames(experiment.k);
  const Vec3i up{0, 0, 1};
  std::vector<PlaneVoxel> voxels;
  VoxelSet set;
  const auto add = [&](const Vec3i& z, uint32_t plane) {
    voxels.push_back({z, up, plane});
    set.Insert(z);
  };
  for (int32_t x = -2; x < 22; ++x) {
    for (int32_t y = -2; y < 22; ++y) add({x, y, 10}, 0);  // cuts the padded volume in two
  }
  const auto measure = [&] { return MeasureMinimality(voxels, Flood(experiment.volume, set, frames)); };
  EXPECT_EQ(measure().minimal, 576U);
  EXPECT_EQ(measure().Ratio(), 0);
  add({5, 5, 11}, 0);  // a second voxel of the same plane on one line: both fail Theorem 8
  EXPECT_EQ(measure().redundant, 2U);
  EXPECT_NEAR(measure().Ratio(), 2.0 / 577, 1e-12);
  voxels.back().plane = 1;  // of another surface, case 2
  EXPECT_EQ(measure().by_other_surface, 2U);
  EXPECT_EQ(measure().Ratio(), 0);
  voxels.push_back({{7, 7, 10}, up, 1});  // on two planes, case 1
  EXPECT_EQ(measure().at_seam, 1U);
}

// The thesis's figures 5.12 to 5.15.
TEST(Minimality, RatioOfTheIncrementalTetrahedraIsZero) {
  for (const bool optimized : {false, true}) {
    for (const Experiment& experiment : Experiments(40)) {
      uint64_t voxels = 0, excluded = 0;
      for (int degrees = 0; degrees < 360; degrees += 15) {
        const SnappedMesh snapped = *Snap(RotatedTetrahedron(degrees, experiment.side), experiment.grid.lattice,
                                          experiment.grid.origin, {2, 2, 2});
        const std::vector<PlaneVoxel> listed = PlaneVoxels(snapped, experiment, optimized);
        VoxelSet set;
        for (const PlaneVoxel& v : listed) set.Insert(v.ijk);
        const Minimality measured =
            MeasureMinimality(listed, Flood(experiment.volume, set, experiment.grid.lattice.frames(experiment.k)));
        EXPECT_EQ(measured.voxels, set.size());
        EXPECT_EQ(measured.voxels,
                  measured.minimal + measured.at_seam + measured.by_other_surface + measured.redundant);
        EXPECT_EQ(measured.Ratio(), 0) << experiment.name << " at " << degrees << " optimized " << optimized;
        voxels += measured.voxels;
        excluded += measured.at_seam + measured.by_other_surface;
      }
      std::printf("%s%s: %zu voxels, %zu of them excluded\n", optimized ? "optimized " : "", experiment.name.c_str(),
                  static_cast<size_t>(voxels), static_cast<size_t>(excluded));
    }
  }
}

}  // namespace
}  // namespace latvox
