// The estimates of what walks and solids need are upper bounds, and no careless ones.
#include "core/voxelizer/walk_estimate.h"

#include <gtest/gtest.h>
#include <malloc.h>
#include <oneapi/tbb/task_arena.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/request/labels.h"
#include "core/snap/snap.h"
#include "core/solid/labeled_interior.h"
#include "core/voxelizer/estimate.h"
#include "core/voxelizer/voxelizer.h"
#include "core/walk/facts.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/core/walk/answers.h"

namespace {

std::atomic<size_t> held = 0, most_held = 0;  // bytes

void* Allocate(size_t size) {
  void* const memory = std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  const size_t now = held += malloc_usable_size(memory);
  for (size_t most = most_held; most < now && !most_held.compare_exchange_weak(most, now);) continue;
  return memory;
}

void Free(void* memory) {
  held -= malloc_usable_size(memory);
  std::free(memory);
}

}  // namespace

void* operator new(size_t size) { return Allocate(size); }
void* operator new[](size_t size) { return Allocate(size); }
void operator delete(void* memory) noexcept { Free(memory); }
void operator delete[](void* memory) noexcept { Free(memory); }
void operator delete(void* memory, size_t) noexcept { Free(memory); }
void operator delete[](void* memory, size_t) noexcept { Free(memory); }

namespace latvox {
namespace {

// With `close`, a tile that the walk reaches in part takes its points, and what a tile without `close` takes.
constexpr double kBytesPerTile = kBytesPerReachedTile + 300;

struct Measured {
  double bytes;  // that the walks keep
  double bound;
};

Measured Measure(const TriangleMesh& mesh, const Grid& grid, const VoxelizeOptions& options) {
  const VoxelRequest request = MakeRequest(options).value();
  const MeshExtent extent = ExtentOf(mesh);
  const double tiles = MostWallTiles(mesh, extent, grid, request, MostWalks(mesh, request));
  auto job = VoxelizeJob::Create(mesh, grid, options).value();
  const size_t before = held;
  oneapi::tbb::task_arena(1).execute([&] { EXPECT_TRUE(job->Prepare().ok()); });
  return {static_cast<double>(held - before), tiles * kBytesPerTile};
}

TriangleMesh Triangle(const Vec3f& at, const Vec3f& e, const Vec3f& f) { return {{at, at + e, at + f}, {{0, 1, 2}}}; }

void Append(const TriangleMesh& more, TriangleMesh& mesh) {
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const auto& [a, b, c] : more.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
}

// Small triangles far from each other.
TriangleMesh Dust(int count, float side) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(0, side);
  TriangleMesh dust;
  for (int n = 0; n < count; ++n) {
    Append(Triangle({place(random), place(random), place(random)}, {1, 0, 0}, {0, 1, 0.5F}), dust);
  }
  return dust;
}

struct Case {
  std::string name;
  TriangleMesh mesh;
  double close;  // voxel sizes
};

std::vector<Case> Cases() {
  return {{"a small triangle", Triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0.5F}), 260},
          {"a large triangle", Triangle({0, 0, 0}, {500, 40, 30}, {-70, 450, 300}), 40},
          {"a needle", Triangle({0, 0, 0}, {900, 800, 700}, {900, 800, 701}), 40},
          {"dust", Dust(20, 1500), 60},
          {"a sphere", Sphere(60, 100), 10}};
}

TEST(WallTiles, AreNoMoreThanTheBound) {
  for (const NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc}) {
    const Grid grid = Unscaled(Lattice::Named(name));
    for (const auto& [of, mesh, close] : Cases()) {
      SCOPED_TRACE(of);
      const double width = close * grid.lattice.voxel_size();
      const auto [bytes, bound] = Measure(mesh, grid, {.set = Enclosed{.close = width}});
      EXPECT_GT(bytes, 10 * kBytesPerTile);
      EXPECT_LE(bytes, bound);
      EXPECT_LE(bound, 12 * bytes);
    }
  }
}

TEST(WallTiles, CountForEachLabel) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  TriangleMesh mesh;
  for (uint32_t label = 0; label < 6; ++label) {
    const float at = static_cast<float>(label);
    Append(Triangle({at, 2 * at, 0}, {1, 0, 0}, {0, 1, 0.5F}), mesh);
    mesh.attributes.insert(mesh.attributes.end(), 3, label);
  }
  const VoxelizeOptions options{.set = Enclosed{.close = 140, .labels = Field::kPart}, .fields = {Field::kPart}};
  const auto [bytes, bound] = Measure(mesh, grid, options);
  EXPECT_GT(bytes, 6 * 20 * kBytesPerTile);
  EXPECT_LE(bytes, bound);
  EXPECT_LE(bound, 4 * bytes);
}

// So many triangles far apart that cubes of tiles become larger.
TEST(WallTiles, OfVeryManyAreCountedInLargerCubes) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const TriangleMesh mesh = Dust(400000, 60000);
  const VoxelRequest request = MakeRequest({.set = Enclosed{}}).value();
  const double tiles = MostWallTiles(mesh, ExtentOf(mesh), grid, request, 1);
  EXPECT_GE(tiles, 400000);
  EXPECT_LE(tiles, 8 * 400000);
}

// All walks of a job together count their tiles in larger cubes.
TEST(WallTiles, OfManyLabelsAreCountedInLargerCubes) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  TriangleMesh mesh = Dust(400000, 60000);
  for (uint32_t n = 0; n < mesh.vertices.size(); ++n) mesh.attributes.push_back(n / 3 % kMaxWalkLabels);
  const VoxelizeOptions options{.set = Enclosed{.labels = Field::kPart}, .fields = {Field::kPart}};
  const VoxelRequest request = MakeRequest(options).value();
  const double walks = MostWalks(mesh, request);
  ASSERT_EQ(walks, double{kMaxWalkLabels});
  const MeshExtent extent = ExtentOf(mesh);
  const size_t before = held;
  most_held = before;
  EXPECT_GE(MostWallTiles(mesh, extent, grid, request, walks), 400000);
  EXPECT_LE(most_held - before, size_t{24} << 20);
}

// More labels than cubes, so larger cubes are no fewer.
TEST(WallTiles, EndWithMoreLabelsThanAJobMayHave) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  TriangleMesh mesh = Dust(300000, 3000);
  for (uint32_t n = 0; n < mesh.vertices.size(); ++n) mesh.attributes.push_back(n / 3);
  const VoxelizeOptions options{.set = Enclosed{.labels = Field::kPart}, .fields = {Field::kPart}};
  const VoxelRequest request = MakeRequest(options).value();
  EXPECT_GT(MostWallTiles(mesh, ExtentOf(mesh), grid, request, MostWalks(mesh, request)), 0);
  EXPECT_EQ(VoxelizeJob::Create(mesh, grid, options).status().code(), absl::StatusCode::kResourceExhausted);
}

// Flat boxes one above the other, with a side of so many voxels.
TriangleMesh FlatBoxes(int count, int side) {
  oracle::Mesh boxes;
  for (int n = 0; n < count; ++n) {
    const oracle::Mesh box =
        Box({0, 0, n * 3 * kLatticeUnit}, {side * kLatticeUnit, side * kLatticeUnit, kLatticeUnit});
    boxes.insert(boxes.end(), box.begin(), box.end());
  }
  return ToWorld(boxes, Lattice::Named(NamedLattice::kCartesian));
}

// Returns the bytes that the job takes before its first tile at most.
double MostBytesBefore(const TriangleMesh& mesh, const Grid& grid, const VoxelizeOptions& options) {
  auto job = VoxelizeJob::Create(mesh, grid, options).value();
  const size_t before = held;
  most_held = before;
  oneapi::tbb::task_arena(1).execute([&] { EXPECT_TRUE(job->Prepare().ok()); });
  return static_cast<double>(most_held - before);
}

// Of a closed mesh: those of one line in 64^2.
TEST(LineCrossings, OfClosedMeshesAreCounted) {
  constexpr double kFixedBytes = 1 << 21;
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  TriangleMesh boxes = FlatBoxes(3, 20000);
  boxes.attributes.resize(boxes.vertex_count());
  const std::vector<VoxelizeOptions> all{
      {.set = Solid{}},
      {.shard = Shard{0, kMaxShards}, .set = Solid{}},
      {.region = IndexBox{{0, 0, 0}, {20000, 10000, 1}}, .set = Solid{}},
      {.bounds = Bounds{{0, 0, 0}, {20000, 10000, 1}}, .set = Solid{}},
      {.set = Solid{.labels = Field::kPart}, .fields = {Field::kPart}},
      {.region = IndexBox{{0, 0, 0}, {20000, 3000, 1}}, .fields = {Field::kFraction}, .fraction_n = 4},
      {.shard = Shard{0, kMaxShards}, .set = Links{LinkSide::kInside}}};
  for (size_t n = 0; n < all.size(); ++n) {
    const VoxelRequest request = MakeRequest(all[n]).value();
    TriangleMesh mesh = boxes;
    if (!request.labels()) mesh.attributes.clear();
    const double crossings = EstimateLineCrossings(mesh, grid, request);
    const double bound = crossings * (request.labels() ? kBytesPerLabeledCrossing : kBytesPerLineCrossing);
    const double bytes = MostBytesBefore(mesh, grid, all[n]);
    // The array of all crossings is not among the bytes, because it has pages of its own.
    EXPECT_GT(bytes, kFixedBytes) << n;
    EXPECT_LE(bytes, bound + kFixedBytes) << n;
    EXPECT_LE(bound, 8 * bytes) << n;
  }
  EXPECT_EQ(EstimateLineCrossings(boxes, grid, {}), 0);
}

TEST(WalkPoints, HoldWhatCloseKeepsTheWalkOutOf) {
  for (const NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc}) {
    const Grid grid = Unscaled(Lattice::Named(name));
    const TriangleMesh mesh = Triangle({0, 0, 0}, {9, 0, 0}, {0, 8, 7});
    for (const double close : {0.0, 50.0}) {
      const VoxelizeOptions options{.set = Enclosed{.close = close, .leak_from = Vec3d{-200, 0, 0}}};
      auto job = VoxelizeJob::Create(mesh, grid, options).value();
      ASSERT_TRUE(job->Prepare().ok());
      const auto points = static_cast<double>(job->facts().walk->leak->box_points);
      const double most = MostWalkPoints(ExtentOf(mesh), grid, MakeRequest(options).value());
      EXPECT_LE(points, most);
      EXPECT_LE(most, 80 * points);  // room for steps and blocks, around few points
    }
  }
}

// A room without one of its outer triangles. The way leads through most of it.
TEST(WalkPoints, TakeTwoBytesEachInTheSearchForALeak) {
  oracle::Mesh room = Box({0, 0, 0}, {50000, 50000, 50000});
  room.erase(room.begin());
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const TriangleMesh mesh = ToWorld(room, lattice);
  const VoxelizeOptions options{.set = Enclosed{.close = 20, .leak_from = Vec3d{150, 150, 150}}};
  const VoxelRequest request = MakeRequest(options).value();
  const MeshExtent extent = ExtentOf(mesh);
  auto job = VoxelizeJob::Create(mesh, Unscaled(lattice), options).value();
  const size_t before = held;
  most_held = before;
  oneapi::tbb::task_arena(1).execute([&] { EXPECT_TRUE(job->Prepare().ok()); });
  ASSERT_EQ(job->facts().walk->leak->kind, Leak::kFound);
  const double points = MostWalkPoints(extent, Unscaled(lattice), request);
  EXPECT_GT(points, 8e6);
  constexpr double kBytesOfScan = 8 << 20, kBytesPerPackedTile = 24 << 10;
  const double tiles = MostWallTiles(mesh, extent, Unscaled(lattice), request, 1);
  EXPECT_LE(static_cast<double>(most_held - before),
            2 * points + tiles * (kBytesPerTile + kBytesPerPackedTile) + kBytesOfScan);
}

}  // namespace
}  // namespace latvox
