// Cancelled and interrupted jobs end soon at every stage, even where very many triangles or lines meet.
#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <cctype>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/snap/finer_mesh.h"
#include "core/solid/labels.h"
#include "core/voxelizer/voxelizer.h"
#include "core/voxelizer/walk_estimate.h"
#include "tests/unit/core/job_kinds.h"
#include "tests/unit/core/most_to_stop.h"

namespace latvox {
namespace {

// Triangles some voxels wide, in a single tile.
TriangleMesh Heap(uint32_t triangles) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> place(0, 40), corner(-1.5, 1.5);
  TriangleMesh heap;
  for (uint32_t n = 0; n < 3 * triangles; n += 3) {
    const Vec3f at{place(random), place(random), place(random)};
    for (int c = 0; c < 3; ++c) {
      heap.vertices.push_back({at[0] + corner(random), at[1] + corner(random), at[2] + corner(random)});
    }
    heap.triangles.push_back({n, n + 1, n + 2});
  }
  return heap;
}

TEST(Cancelling, StopsAHeapOfTrianglesInOneTile) { EXPECT_LT(MostToStopJob(320000, Heap, {"", 0, {}}), kPromised); }

class EveryKindOfJob : public testing::TestWithParam<JobKind> {};

TEST_P(EveryKindOfJob, StopsWhenCancelled) {
  const auto heap = [](uint32_t tetrahedra) { return HeapOfTetrahedra(tetrahedra); };
  EXPECT_LT(MostToStopJob(GetParam().tetrahedra, heap, GetParam()), kPromised);
}

INSTANTIATE_TEST_SUITE_P(Cancelling, EveryKindOfJob, testing::ValuesIn(JobKinds()), [](const auto& kind) {
  std::string name = kind.param.name;
  std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
  return name;
});

// A walk of labels copies and sorts each label's triangles before it looks at any.
TEST(Cancelling, StopsALabeledWalkOfManyTrianglesInFewVoxels) {
  const auto heap = [](uint32_t tetrahedra) { return HeapOfTetrahedra(tetrahedra, 2, 0.5); };
  const JobKind kind{
      "", 0, {.set = Enclosed{.leak_from = Vec3d{1, 1, 1}, .labels = Field::kPart}, .fields = {Field::kPart}}};
  EXPECT_LT(MostToStopJob(400000, heap, kind), kPromised);
}

// The crossings of all layers lie in one slab.
TEST(Cancelling, StopsAnOpenSolidOfLayersInOneSlab) {
  const auto layers = [](uint32_t count) {
    TriangleMesh mesh;
    for (uint32_t n = 0; n < count; ++n) {
      const auto at = static_cast<uint32_t>(mesh.vertices.size());
      const auto k = static_cast<float>(2 * n);
      for (const auto& [i, j] : {std::pair(0.F, 0.F), {60.F, 0.F}, {60.F, 4000.F}, {0.F, 4000.F}}) {
        mesh.vertices.push_back({i, j, k});
      }
      mesh.triangles.insert(mesh.triangles.end(), {{at, at + 1, at + 2}, {at, at + 2, at + 3}});
    }
    return mesh;
  };
  EXPECT_LT(MostToStopJob(20, layers, {"", 0, {.set = Solid{.force_open = true}}}), kPromised);
}

// All vertices are looked at before any is moved.
TEST(Cancelling, StopsToMakeAFinerMesh) {
  SnappedMesh mesh;
  PaddedVector<Vec3i> vertices(1 << 20);
  for (size_t n = 0; n < vertices.size(); ++n) vertices[n] = {static_cast<int32_t>(8 * n), 0, 0};
  mesh.vertices_lat = std::move(vertices);
  StopSource stop;
  stop.Stop();
  const auto finer = MakeFinerMesh(mesh, 16, {0, 0, 0}, stop.Signal());
  ASSERT_TRUE(finer.ok()) << finer.status();  // the range of all vertices would be an error
  EXPECT_TRUE(MakeFinerMesh(mesh, 16, {0, 0, 0}).status().code() == absl::StatusCode::kResourceExhausted);
}

TEST(Cancelling, StopsToCountLabels) {
  TriangleMesh mesh = HeapOfTetrahedra(10000);
  const JobKind kind{"", 0, {.set = Enclosed{.labels = Field::kPart}, .fields = {Field::kPart}}};
  for (uint32_t n = 0; n < mesh.vertices.size(); ++n) mesh.attributes.push_back(n % 7);
  const absl::StatusOr<VoxelRequest> request = MakeRequest(kind.options);
  ASSERT_TRUE(request.ok()) << request.status();
  StopSource stop;
  EXPECT_EQ(MostWalks(mesh, *request, stop.Signal()), 7);
  stop.Stop();
  EXPECT_EQ(MostWalks(mesh, *request, stop.Signal()), 0);
}

TEST(Cancelling, StopsToSortTrianglesByLabel) {
  Labels labels{.numbers = {5, 9}, .of_triangles = std::vector<uint16_t>(100000, 1)};
  StopSource stop;
  EXPECT_EQ(labels.ByRank(stop.Signal()).Of(1).size(), 100000U);
  stop.Stop();
  EXPECT_EQ(labels.ByRank(stop.Signal()).Of(1).size(), 0U);
}

struct Interrupting : Digitizing {
  void Cancel() { job->Interrupt(); }
};

TEST(Interrupting, StopsInTheMiddleOfATile) {
  const auto heap = [](uint32_t tetrahedra) { return HeapOfTetrahedra(tetrahedra); };
  const auto digitizing = [](const TriangleMesh& mesh) {
    return std::make_unique<Interrupting>(Digitizing{JobKind{"", 0, {}}.Job(mesh)});
  };
  EXPECT_LT(MostToStop(40000, heap, digitizing), kPromised);
}

struct Verifying : Digitizing {
  const VoxelSet voxels = {};
  void Run() {
    oneapi::tbb::task_arena(1).execute([&] { job->Verify(voxels).IgnoreError(); });
  }
};

TEST(Cancelling, StopsToVerifyInTheMiddleOfATriangle) {
  const auto triangle = [](uint32_t size) {
    const auto side = static_cast<float>(size);
    return TriangleMesh{{{0, 0, 0}, {side, 0, side / 40}, {0, side, side / 20}}, {{0, 1, 2}}};
  };
  const JobKind kind{"", 0, {.separability = 2}};
  const auto verifying = [&](const TriangleMesh& mesh) {
    return std::make_unique<Verifying>(Digitizing{kind.Job(mesh)});
  };
  EXPECT_LT(MostToStop(1600, triangle, verifying), kPromised);
}

}  // namespace
}  // namespace latvox
