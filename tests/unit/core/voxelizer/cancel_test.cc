// Cancelled and interrupted jobs end soon at every stage, even where very many triangles or lines meet.
#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <cctype>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "core/voxelizer/voxelizer.h"
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
