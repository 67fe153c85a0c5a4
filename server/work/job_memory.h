// The memory of one voxelization: how many bytes each step needs, and their reservation.
#ifndef LATVOX_SERVER_WORK_JOB_MEMORY_H_
#define LATVOX_SERVER_WORK_JOB_MEMORY_H_

#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "core/mesh/mesh.h"
#include "core/request/request.h"
#include "server/work/memory_budget.h"

namespace latvox {

// The facts known about a job before it begins.
struct JobEstimate {
  double voxels = 0;          // the number of voxels that it finds
  double line_crossings = 0;  // the number that it keeps to find the inside
  Bounds bounds;              // of the mesh, world units
  double voxel_size = 0;      // world units
  double walks = 0;           // the number of walks: one for each label
  double wall_tiles = 0;      // the most tiles that these find walls in or near
  double walk_points = 0;     // the most lattice points of the box that they look at
};

// Each step reserves its memory before it allocates it:
//
//   ReserveUpload … ──▶ ReserveDecode ──▶ ReserveMesh ──▶ ReserveJob ──▶ ReserveKept …
//
// Errors of all steps: as MemoryReservation::Grow; earlier reservations stay. The destructor gives them back.
// Threads: one at a time.
class JobMemory {
 public:
  //   request   must outlive this
  //   threads   that scan at the same time
  //   budget    must outlive this
  //   client    that the job counts for
  JobMemory(const VoxelRequest& request, int threads, MemoryBudget& budget, std::string client = "");

  // Reserves for an encoded mesh of so many bytes in all.
  absl::Status ReserveUpload(uint64_t bytes);

  // Reserves for the encoded mesh, and for a job with the decoded mesh.
  absl::Status ReserveDecode(uint64_t encoded_bytes, uint64_t triangles, uint64_t vertices);

  // Reserves for a job with the decoded mesh. Gives the encoded mesh's memory back.
  absl::Status ReserveMesh(uint64_t triangles, uint64_t vertices);

  // Reserves the other memory of the job, including the bricks that verification keeps. Call it once, after
  // ReserveMesh.
  absl::Status ReserveJob(const JobEstimate& estimate);

  // Reserves for more bricks that verification keeps, after it has used up those of ReserveJob.
  absl::Status ReserveKept(uint64_t bricks);

  // Gives everything back.
  void Free();

  // The most that was reserved at any time.
  uint64_t most_bytes() const { return memory_.most_bytes(); }

 private:
  uint64_t SearchBytesPerTriangle(const FieldList& nearest) const;
  uint64_t BytesOf(uint64_t triangles, uint64_t vertices) const;
  uint64_t BytesOfSolid(double line_crossings) const;
  uint64_t FractionLabels() const;
  uint64_t BytesOfWalk(const JobEstimate& estimate) const;
  uint64_t BytesOfThinning(const JobEstimate& estimate) const;

  const VoxelRequest& request_;
  const uint64_t threads_;
  MemoryReservation memory_;
  uint64_t job_bytes_ = 0, kept_bytes_ = 0;  // parts of memory_, by their purpose
};

}  // namespace latvox

#endif  // LATVOX_SERVER_WORK_JOB_MEMORY_H_
