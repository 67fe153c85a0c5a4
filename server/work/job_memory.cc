#include "server/work/job_memory.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/fields/near_numbers.h"
#include "core/fields/triangle_index.h"
#include "core/solid/interior.h"
#include "core/solid/labeled_interior.h"
#include "core/solid/labels.h"
#include "core/voxelizer/labeled_walk.h"
#include "core/walk/facts.h"
#include "core/walk/growth.h"
#include "core/walk/packed_pieces.h"

namespace latvox {
namespace {

// The stream: the reactor's credit, and the memory of gRPC and the kernel for a slow client.
constexpr uint64_t kStreamBytes = uint64_t{8} << 20;

// A thread: the memory of its scan.
constexpr uint64_t kThreadBytes = uint64_t{6} << 20;
constexpr uint64_t kSolidThreadBytes = uint64_t{2} << 20;
// With labels: the crossings of a tile, the labels of its points, and the runs of labels of two.
constexpr uint64_t kLabelThreadBytes = uint64_t{12} << 20;
// With fields: the search, and the fields of blocks in flight: of two tiles of a solid or a band, which may be full, or
// of two blocks of a surface, as measured.
constexpr uint64_t kFieldThreadBytes = uint64_t{4} << 20, kFieldThreadVoxels = uint64_t{2} << 20;
// The same for fields of many numbers, which are too large for such generosity: two full tiles, or blocks of a surface.
constexpr uint64_t kLargeFieldThreadVoxels = uint64_t{1} << 19;

// Numbers of the mesh alone take lists of the triangles near two cubes. A triangle is seldom near more than two tiles
// in flight.
constexpr uint64_t kListBytesPerTriangle = 2 * 2 * NearNumbers::kBytesPerTriangle;

// The mesh: its arrays and those of the job, as measured, and half as much again. A field of the mesh counts twice for
// each vertex: in the job's mesh, and in a mesh that the store has dropped since.
constexpr uint64_t kBytesPerTriangle = 48, kBytesPerVertex = 24;
constexpr uint64_t kBytesPerMeshField = 8;

// Fractions: the inside of two tiles in each thread, and for each label once more; and the vertices of the finer mesh.
constexpr uint64_t kFractionThreadBytes = uint64_t{3} << 20, kFractionBytesPerVertex = 18;
constexpr uint64_t kLabelFractionThreadBytes = uint64_t{128} << 10;

// Thinning: where triangles fill a volume, many voxels of a block of 128^3 are in doubt.
constexpr double kBlockSide = 128, kBytesPerVoxelOfBlock = 60, kMostBytesOfBlock = 84 << 20;

// Kept sets: a brick lies in a vector and an index that double as they grow. Where the number of bricks is unknown, it
// follows from the number of voxels: a surface has at least ten in a brick.
constexpr uint64_t kBytesPerKeptBrick = 250;
constexpr double kBytesPerKeptVoxel = 25;

// An estimate may exceed all 64-bit numbers. No budget has that much.
uint64_t ToBytes(double bytes) { return static_cast<uint64_t>(std::min(bytes, 1e18)); }

}  // namespace

JobMemory::JobMemory(const VoxelRequest& request, int threads, MemoryBudget& budget, std::string client)
    : request_(request), threads_(static_cast<uint64_t>(threads)), memory_(budget, std::move(client)) {}

absl::Status JobMemory::ReserveUpload(uint64_t bytes) { return memory_.Grow(bytes); }

absl::Status JobMemory::ReserveDecode(uint64_t encoded_bytes, uint64_t triangles, uint64_t vertices) {
  return memory_.Grow(encoded_bytes + BytesOf(triangles, vertices));
}

absl::Status JobMemory::ReserveMesh(uint64_t triangles, uint64_t vertices) {
  job_bytes_ = BytesOf(triangles, vertices);
  memory_.Shrink(job_bytes_);
  return memory_.Grow(job_bytes_);
}

absl::Status JobMemory::ReserveJob(const JobEstimate& estimate) {
  const uint64_t kept = ToBytes(estimate.voxels * kBytesPerKeptVoxel);
  job_bytes_ += BytesOfSolid(estimate.line_crossings) + BytesOfWalk(estimate) + BytesOfThinning(estimate);
  if (request_.algorithm() != Algorithm::kExact) job_bytes_ += kept;
  // Reserves for verification now, by an estimate that is seldom too low, because an accepted job should end.
  return memory_.Grow(request_.verify ? job_bytes_ + kept : job_bytes_);
}

absl::Status JobMemory::ReserveKept(uint64_t bricks) {
  kept_bytes_ += bricks * kBytesPerKeptBrick;
  return memory_.Grow(job_bytes_ + kept_bytes_);
}

void JobMemory::Free() { memory_.Shrink(0); }

// For the search for the nearest triangles, by an index or lists.
uint64_t JobMemory::SearchBytesPerTriangle(const FieldList& nearest) const {
  if (nearest.empty()) return 0;
  static_assert(kListBytesPerTriangle > TriangleIndex::kBytesPerTriangle);
  return nearest == request_.fields.OfMesh() ? kListBytesPerTriangle : TriangleIndex::kBytesPerTriangle;
}

// For a job with a mesh of this size.
uint64_t JobMemory::BytesOf(uint64_t triangles, uint64_t vertices) const {
  const FieldList nearest = request_.fields.OfNearest();
  const bool has_fraction = request_.fraction_n != 0;
  const uint64_t small = nearest.bytes(0, 0) + request_.fields.OfCells().bytes(0, 0);
  const uint64_t large = request_.fields.OfLinks().bytes(kMostNeighbors, 0) + FractionLabels() * sizeof(uint16_t);
  const uint64_t of_thread = (request_.fields.empty() ? 0 : kFieldThreadBytes) + kFieldThreadVoxels * small +
                             kLargeFieldThreadVoxels * large + (has_fraction ? kFractionThreadBytes : 0) +
                             FractionLabels() * kLabelFractionThreadBytes;
  const bool is_labeled = request_.labels().has_value();
  const uint64_t of_triangle = SearchBytesPerTriangle(nearest) + (is_labeled ? kLabelBytesPerTriangle : 0) +
                               (is_labeled && request_.walk() != nullptr ? kLabeledWalkBytesPerTriangle : 0);
  return kStreamBytes + threads_ * (kThreadBytes + of_thread) + triangles * (kBytesPerTriangle + of_triangle) +
         vertices * (kBytesPerVertex + request_.fields.OfMesh().size() * kBytesPerMeshField +
                     (has_fraction ? kFractionBytesPerVertex : 0));
}

// More for a job that finds the inside.
uint64_t JobMemory::BytesOfSolid(double line_crossings) const {
  if (!request_.needs_inside()) return 0;
  if (request_.solid() == nullptr || !request_.labels())
    return threads_ * kSolidThreadBytes + ToBytes(line_crossings * kBytesPerLineCrossing);
  return threads_ * (kSolidThreadBytes + kLabelThreadBytes) + ToBytes(line_crossings * kBytesPerLabeledCrossing);
}

// The most labels whose fractions voxels may carry.
uint64_t JobMemory::FractionLabels() const {
  if (!request_.fields.Contains(Field::kLabelFractions)) return 0;
  return request_.fraction_labels.empty() ? kMostFractionLabels : request_.fraction_labels.size();
}

// More for a job with walks: their pieces, as measured; with `close`, the reached points of tiles; and the search for a
// leak. A region reports a leak, too. With labels, a walk and a plan for each, and what a labeled tile takes.
uint64_t JobMemory::BytesOfWalk(const JobEstimate& estimate) const {
  constexpr double kBytesPerWallTile = 300, kBytesPerPackedTile = 24 << 10, kBytesPerLeakPoint = 2;
  const WalkSet* const walk = request_.walk();
  if (walk == nullptr) return 0;
  const bool closes = walk->close > 0;
  const double packed = std::min(estimate.wall_tiles * kBytesPerPackedTile, double{kMostPackedBytes});
  const double per_tile = kBytesPerWallTile + (closes ? double{kBytesPerReachedTile} : 0);
  const bool finds_leak = walk->leak_from || (walk->seed && !walk->allow_outside);
  const double searched = std::min(estimate.walk_points, static_cast<double>(kMostLeakPoints));
  const double leak = finds_leak ? searched * kBytesPerLeakPoint : 0;
  const double of_labels = request_.labels() ? estimate.walks * double{kLabeledWalkBytesPerLabel} : 0;
  return threads_ * (kSolidThreadBytes + (request_.labels() ? kLabelThreadBytes : 0)) +
         (closes ? Ball::kMostBytes : 0) + ToBytes(estimate.wall_tiles * per_tile + packed + leak + of_labels);
}

// More for a job that thins: a block's share of the voxels, if they are spread over the requested part of the mesh's
// box.
uint64_t JobMemory::BytesOfThinning(const JobEstimate& estimate) const {
  if (!request_.is_minimal()) return 0;
  double blocks = 1;
  for (size_t m = 0; m < 3; ++m) {
    double side = estimate.bounds.max[m] - estimate.bounds.min[m];
    if (const auto& bounds = request_.part.bounds) side = std::min(side, bounds->max[m] - bounds->min[m]);
    side /= estimate.voxel_size;
    if (const auto& region = request_.part.region)
      side = std::min(side, static_cast<double>(region->max[m]) - region->min[m]);
    blocks *= std::max(side / kBlockSide, 1.0);
  }
  const double bytes = std::min(estimate.voxels / blocks * kBytesPerVoxelOfBlock, kMostBytesOfBlock);
  return threads_ * static_cast<uint64_t>(bytes);
}

}  // namespace latvox
