// How many bytes a job reserves for which request, and that it gives them back.
#include "server/work/job_memory.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/walk/facts.h"
#include "core/walk/growth.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

constexpr uint64_t kMebibyte = uint64_t{1} << 20;
constexpr uint64_t kPlenty = uint64_t{1} << 62;

constexpr int kThreads = 3;
constexpr uint64_t kTriangles = 1000, kVertices = 600;

// The memory of a job with that mesh, before anything is known about its voxels.
constexpr uint64_t kOfMesh = 8 * kMebibyte + 3 * 6 * kMebibyte + 1000 * 48 + 600 * 24;

// So many blocks of 128^3 voxels in the mesh's box: 2 x 3 x 1, though its third side is shorter than a block.
const JobEstimate kSixBlocks{.voxels = 60000, .bounds = {{-64, 0, 0}, {64, 192, 5}}, .voxel_size = 0.5};
constexpr uint64_t kOfThinning = 3 * (60000 / 6) * 60;

VoxelRequest Thinned() { return {}; }
VoxelRequest NotThinned() { return {.set = SurfaceSet{.minimal = false}}; }
VoxelRequest Filled(bool force_open) { return {.set = SolidSet{{.force_open = force_open}, {.minimal = false}}}; }

// The reservation of a request at the end of ReserveMesh.
uint64_t ReservedForMesh(const VoxelRequest& request, int threads, uint64_t triangles, uint64_t vertices) {
  MemoryBudget budget(kPlenty);
  JobMemory memory(request, threads, budget);
  EXPECT_TRUE(memory.ReserveMesh(triangles, vertices).ok());
  return budget.reserved();
}

// The addition of ReserveJob.
uint64_t AddedForJob(const VoxelRequest& request, const JobEstimate& estimate) {
  MemoryBudget budget(kPlenty);
  JobMemory memory(request, kThreads, budget);
  EXPECT_TRUE(memory.ReserveMesh(kTriangles, kVertices).ok());
  const uint64_t before = budget.reserved();
  EXPECT_TRUE(memory.ReserveJob(estimate).ok());
  return budget.reserved() - before;
}

TEST(JobMemory, ReservesForTheStreamEachThreadAndTheMesh) {
  EXPECT_EQ(ReservedForMesh({}, 1, 0, 0), 14 * kMebibyte);
  EXPECT_EQ(ReservedForMesh({}, 8, 0, 0), 56 * kMebibyte);
  EXPECT_EQ(ReservedForMesh({}, 1, 1000, 0), 14 * kMebibyte + 48000);
  EXPECT_EQ(ReservedForMesh({}, 1, 0, 1000), 14 * kMebibyte + 24000);
  EXPECT_EQ(ReservedForMesh({}, kThreads, kTriangles, kVertices), kOfMesh);
}

TEST(JobMemory, ReservesForFieldsByThreadsAndVertices) {
  const VoxelRequest one{.fields = {Field::kColor}}, two{.fields = {Field::kPart, Field::kColor}};
  constexpr uint64_t kOfIndex = kTriangles * 64, kOfLists = kTriangles * 112;
  EXPECT_EQ(ReservedForMesh(one, kThreads, kTriangles, kVertices),
            kOfMesh + 3 * (4 + 2 * 3) * kMebibyte + kOfLists + 600 * 8);
  EXPECT_EQ(ReservedForMesh(two, kThreads, kTriangles, kVertices),
            kOfMesh + 3 * (4 + 2 * 7) * kMebibyte + kOfLists + 600 * 2 * 8);
  const VoxelRequest normal{.fields = {Field::kNormal}};  // the mesh's vertices carry nothing for it
  EXPECT_EQ(ReservedForMesh(normal, kThreads, kTriangles, kVertices),
            kOfMesh + 3 * (4 + 2 * 12) * kMebibyte + kOfIndex);
}

TEST(JobMemory, ReservesForFractions) {
  VoxelRequest fraction = NotThinned();
  fraction.fields = {Field::kFraction};
  fraction.fraction_n = 8;
  EXPECT_EQ(ReservedForMesh(fraction, kThreads, kTriangles, kVertices),
            kOfMesh + 3 * (4 + 2 * 2 + 3) * kMebibyte + 600 * 18);
  EXPECT_EQ(AddedForJob(fraction, kSixBlocks), AddedForJob(NotThinned(), kSixBlocks) + 3 * 2 * kMebibyte);
}

TEST(JobMemory, ReservesForFractionsOfLabels) {
  VoxelRequest fraction = NotThinned(), labels = fraction;
  fraction.fields = {Field::kFraction};
  labels.fields = {Field::kFraction, Field::kLabelFractions};
  fraction.fraction_n = labels.fraction_n = 8;
  const uint64_t plain = ReservedForMesh(fraction, kThreads, kTriangles, kVertices);
  constexpr uint64_t kOfLabel = 3 * (kMebibyte / 2 * 2 + kMebibyte / 8);
  EXPECT_EQ(ReservedForMesh(labels, kThreads, kTriangles, kVertices), plain + 32 * kOfLabel)
      << "as many as there may be";
  labels.fraction_labels = {5, 3};
  EXPECT_EQ(ReservedForMesh(labels, kThreads, kTriangles, kVertices), plain + 2 * kOfLabel);
}

TEST(JobMemory, ReservesForLabels) {
  const auto filled = [](bool open, std::optional<Field> labels) {
    VoxelRequest request = Filled(open);
    std::get<SolidSet>(request.set).solid.labels = labels;
    request.fields = {Field::kPart};
    return request;
  };
  const VoxelRequest plain = filled(true, std::nullopt), labeled = filled(true, Field::kPart);
  EXPECT_EQ(ReservedForMesh(labeled, kThreads, kTriangles, kVertices),
            ReservedForMesh(plain, kThreads, kTriangles, kVertices) + kTriangles * 8);
  JobEstimate estimate;
  estimate.line_crossings = 1000;
  EXPECT_EQ(AddedForJob(labeled, estimate), AddedForJob(plain, estimate) + 3 * 12 * kMebibyte + 1000 * 24);
}

TEST(JobMemory, ReservesForTheWalkOfEachLabel) {
  const auto enclosed = [](std::optional<Field> labels) {
    WalkSet walk;
    walk.surface.minimal = false;
    walk.labels = labels;
    return VoxelRequest{.set = walk, .fields = {Field::kPart}};
  };
  const VoxelRequest plain = enclosed(std::nullopt), labeled = enclosed(Field::kPart);
  EXPECT_EQ(ReservedForMesh(labeled, kThreads, kTriangles, kVertices),
            ReservedForMesh(plain, kThreads, kTriangles, kVertices) + kTriangles * (8 + 20 + 288));
  JobEstimate estimate;
  estimate.walks = 5;
  EXPECT_EQ(AddedForJob(labeled, estimate), AddedForJob(plain, estimate) + 3 * 12 * kMebibyte + 5 * 64 * 1024);
}

TEST(JobMemory, ReservesForReachedTilesAndTheSearchForALeak) {
  WalkSet walk;
  walk.surface.minimal = false;
  JobEstimate estimate;
  estimate.walk_points = 1e9;
  const uint64_t none = AddedForJob({.set = walk}, estimate);
  walk.leak_from = Vec3d{0, 0, 0};
  EXPECT_EQ(AddedForJob({.set = walk}, estimate), none + 2 * kMostLeakPoints);
  estimate.walk_points = 1000;
  EXPECT_EQ(AddedForJob({.set = walk}, estimate), none + 2 * 1000);
  walk.leak_from.reset();
  walk.close = 3;
  estimate.wall_tiles = 10;
  EXPECT_EQ(AddedForJob({.set = walk}, estimate), none + Ball::kMostBytes + 10 * (300 + (32 << 10) + (24 << 10)));
}

TEST(JobMemory, HoldsTheEncodedMeshUntilItIsDecoded) {
  MemoryBudget budget(kPlenty);
  const VoxelRequest request;
  JobMemory memory(request, kThreads, budget);
  ASSERT_TRUE(memory.ReserveUpload(1000).ok());
  EXPECT_EQ(budget.reserved(), 1000);
  ASSERT_TRUE(memory.ReserveUpload(5000).ok());
  EXPECT_EQ(budget.reserved(), 5000);
  ASSERT_TRUE(memory.ReserveDecode(5000, kTriangles, kVertices).ok());
  EXPECT_EQ(budget.reserved(), 5000 + kOfMesh);
  ASSERT_TRUE(memory.ReserveMesh(kTriangles, kVertices).ok());
  EXPECT_EQ(budget.reserved(), kOfMesh);
}

// The decoder may find fewer elements than the file declares.
TEST(JobMemory, GivesBackWhatTheDeclaredSizesHadAndTheDecodedMeshHasNot) {
  MemoryBudget budget(kPlenty);
  const VoxelRequest request;
  JobMemory memory(request, kThreads, budget);
  ASSERT_TRUE(memory.ReserveDecode(100, 10 * kTriangles, 10 * kVertices).ok());
  ASSERT_TRUE(memory.ReserveMesh(kTriangles, kVertices).ok());
  EXPECT_EQ(budget.reserved(), kOfMesh);
}

TEST(JobMemory, ReservesNoMoreForASurfaceThatIsNeitherThinnedNorVerified) {
  EXPECT_EQ(AddedForJob(NotThinned(), kSixBlocks), 0);
  EXPECT_EQ(AddedForJob({.set = SurfaceSet{.cover = Cover::kSupercover, .minimal = false}}, kSixBlocks), 0);
  EXPECT_EQ(AddedForJob({.set = BandSet{}}, kSixBlocks), 0);
}

TEST(JobMemory, ReservesForThinningTheVoxelsOfABlockForEachThread) {
  EXPECT_EQ(AddedForJob(Thinned(), kSixBlocks), kOfThinning);
  EXPECT_EQ(AddedForJob({.set = SolidSet{}}, kSixBlocks), kOfThinning + 3 * 2 * kMebibyte);
  JobEstimate small = kSixBlocks;
  small.bounds = {{0, 0, 0}, {1, 1, 1}};
  EXPECT_EQ(AddedForJob(Thinned(), small), 3 * 60000 * 60);
}

TEST(JobMemory, ReservesForThinningNoMoreThanABlockCanHave) {
  JobEstimate dense = kSixBlocks;
  dense.voxels = 1e30;
  EXPECT_EQ(AddedForJob(Thinned(), dense), 3 * 84 * kMebibyte);
}

TEST(JobMemory, SpreadsVoxelsOverThePartThatIsAskedFor) {
  VoxelRequest request = Thinned();
  request.part.bounds = {{0, 0, 0}, {1000, 64, 1000}};  // 128 voxels of the second side
  EXPECT_EQ(AddedForJob(request, kSixBlocks), 3 * (60000 / 2) * 60);
  request.part.bounds.reset();
  request.part.region = {{0, -100, 0}, {1000, 92, 1000}};  // 192 voxels of it
  EXPECT_EQ(AddedForJob(request, kSixBlocks), 3 * (60000 / 3) * 60);
  request.part.bounds = {{0, 0, 0}, {32, 1000, 1000}};  // and 64 of the first
  EXPECT_EQ(AddedForJob(request, kSixBlocks), 3 * (60000 * 2 / 3) * 60);
}

TEST(JobMemory, ReservesForAFillByThreadsAndLineCrossings) {
  EXPECT_EQ(AddedForJob(Filled(false), kSixBlocks), 3 * 2 * kMebibyte);
  JobEstimate open = kSixBlocks;
  open.line_crossings = 12345;
  EXPECT_EQ(AddedForJob(Filled(true), open), 3 * 2 * kMebibyte + 12345 * 24);
  open.line_crossings = 1e30;
  EXPECT_EQ(AddedForJob(Filled(true), open), 3 * 2 * kMebibyte + 1'000'000'000'000'000'000);
  EXPECT_EQ(AddedForJob(NotThinned(), open), 0);
}

TEST(JobMemory, ReservesForTheSetThatTheThesissAlgorithmsKeep) {
  for (const Algorithm algorithm :
       {Algorithm::kBruteForce, Algorithm::kIncremental, Algorithm::kOptimizedIncremental}) {
    VoxelRequest request{.set = SurfaceSet{.algorithm = algorithm, .minimal = false}};
    EXPECT_EQ(AddedForJob(request, kSixBlocks), 60000 * 25);
    request.verify = true;  // a second set
    EXPECT_EQ(AddedForJob(request, kSixBlocks), 2 * 60000 * 25);
  }
}

TEST(JobMemory, ReservesBeforehandWhatVerificationKeeps) {
  VoxelRequest request = NotThinned();
  request.verify = true;
  EXPECT_EQ(AddedForJob(request, kSixBlocks), 60000 * 25);
  request = Thinned();
  request.verify = true;
  EXPECT_EQ(AddedForJob(request, kSixBlocks), kOfThinning + 60000 * 25);
  JobEstimate dense = kSixBlocks;
  dense.voxels = 1e30;
  EXPECT_EQ(AddedForJob(request, dense), 3 * 84 * kMebibyte + 1'000'000'000'000'000'000);
}

TEST(JobMemory, ReservesMoreForKeptBricksOnlyBeyondTheEstimate) {
  MemoryBudget budget(kPlenty);
  VoxelRequest request = Thinned();
  request.verify = true;
  JobMemory memory(request, kThreads, budget);
  ASSERT_TRUE(memory.ReserveMesh(kTriangles, kVertices).ok());
  ASSERT_TRUE(memory.ReserveJob(kSixBlocks).ok());
  const uint64_t accepted = kOfMesh + kOfThinning + 60000 * 25;
  for (int n = 1; n <= 6; ++n) {
    ASSERT_TRUE(memory.ReserveKept(1000).ok());
    EXPECT_EQ(budget.reserved(), accepted) << n;
  }
  ASSERT_TRUE(memory.ReserveKept(1000).ok());
  EXPECT_EQ(budget.reserved(), kOfMesh + kOfThinning + 7000 * 250);
}

// The steps of a job that needs each of them, and what is reserved after each.
struct Step {
  std::function<absl::Status(JobMemory&)> reserve;
  uint64_t reserved;
};

std::vector<Step> AllSteps() {
  const uint64_t job = kOfMesh + kOfThinning;
  return {{[](JobMemory& memory) { return memory.ReserveUpload(5000); }, 5000},
          {[](JobMemory& memory) { return memory.ReserveDecode(5000, kTriangles, kVertices); }, 5000 + kOfMesh},
          {[](JobMemory& memory) { return memory.ReserveMesh(kTriangles + 1000, kVertices); }, kOfMesh + 48000},
          {[](JobMemory& memory) { return memory.ReserveJob(kSixBlocks); }, 48000 + job + 60000 * 25},
          {[](JobMemory& memory) { return memory.ReserveKept(7000); }, 48000 + job + 7000 * 250}};
}

// Runs the steps up to the first that fails, and returns its status.
absl::Status RunSteps(JobMemory& memory) {
  for (const Step& step : AllSteps()) {
    if (absl::Status status = step.reserve(memory); !status.ok()) return status;
  }
  return absl::OkStatus();
}

VoxelRequest Verified() { return {.verify = true}; }

TEST(JobMemory, GivesEverythingBackAtAnyStep) {
  const VoxelRequest request = Verified();
  MemoryBudget budget(kPlenty);
  for (size_t count = 0; count <= AllSteps().size(); ++count) {
    for (const bool free : {false, true}) {
      JobMemory memory(request, kThreads, budget);
      for (size_t n = 0; n < count; ++n) {
        ASSERT_TRUE(AllSteps()[n].reserve(memory).ok());
        ASSERT_EQ(budget.reserved(), AllSteps()[n].reserved) << n;
      }
      if (!free) continue;
      memory.Free();
      EXPECT_EQ(budget.reserved(), 0) << count;
    }
    EXPECT_EQ(budget.reserved(), 0) << count;
  }
}

TEST(JobMemory, RefusesTheStepThatIsOverTheBudgetAndGivesEverythingBack) {
  const VoxelRequest request = Verified();
  for (const Step& step : AllSteps()) {
    MemoryBudget budget(step.reserved - 1);
    {
      JobMemory memory(request, kThreads, budget);
      const absl::Status status = RunSteps(memory);
      EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
      const std::string need = std::to_string(step.reserved), limit = std::to_string(step.reserved - 1);
      EXPECT_EQ(status.message(), "memory " + need + " exceeds " + limit);
      EXPECT_EQ(CauseOf(status)->reason, "LIMIT_EXCEEDED");
      EXPECT_EQ(CauseOf(status)->field, "memory");
    }
    EXPECT_EQ(budget.reserved(), 0) << step.reserved;
  }
}

TEST(JobMemory, AsksForAnotherTryWhereOthersHaveTheMemory) {
  const VoxelRequest request = Verified();
  for (const Step& step : AllSteps()) {
    MemoryBudget budget(100 + step.reserved - 1);
    MemoryReservation others(budget);
    ASSERT_TRUE(others.Grow(100).ok());
    {
      JobMemory memory(request, kThreads, budget);
      const absl::Status status = RunSteps(memory);
      EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
      EXPECT_EQ(status.message(), "memory: " + std::to_string(step.reserved) +
                                      " bytes are needed, and others have 100 of " + std::to_string(budget.total()) +
                                      "; try again");
      EXPECT_EQ(CauseOf(status)->reason, "MEMORY_IN_USE");
    }
    EXPECT_EQ(budget.reserved(), 100) << step.reserved;
  }
}

}  // namespace
}  // namespace latvox
