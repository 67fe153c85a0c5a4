// The memory of one voxelization: how many bytes each step needs, and their reservation.
#ifndef LATVOX_SERVER_WORK_JOB_MEMORY_H_
#define LATVOX_SERVER_WORK_JOB_MEMORY_H_

#include <cstdint>

#include "absl/status/status.h"
#include "core/mesh/mesh.h"
#include "core/request/request.h"
#include "server/work/memory_budget.h"

namespace latvox {

// What is known of a job before it begins.
struct JobEstimate {
  double voxels = 0;          // that it finds
  double line_crossings = 0;  // that it keeps, if it fills a mesh that may be open
  Bounds bounds;              // of the mesh, world units
  double voxel_size = 0;      // world units
};

// Each step reserves its memory before it allocates it:
//
//   ReserveUpload … ──▶ ReserveDecode ──▶ ReserveMesh ──▶ ReserveJob ──▶ ReserveKept …
//
// Errors of all steps: as MemoryReservation::Grow; what was reserved before stays. The destructor gives it back.
// Threads: one at a time.
class JobMemory {
 public:
  //   request   must outlive this
  //   threads   that scan at the same time
  //   budget    must outlive this
  JobMemory(const VoxelRequest& request, int threads, MemoryBudget& budget);

  // For an encoded mesh, of so many bytes altogether.
  absl::Status ReserveUpload(uint64_t bytes);

  // For the encoded mesh, and a job with what it decodes to.
  absl::Status ReserveDecode(uint64_t encoded_bytes, uint64_t triangles, uint64_t vertices);

  // For a job with the decoded mesh. Gives back what the encoded mesh had.
  absl::Status ReserveMesh(uint64_t triangles, uint64_t vertices);

  // For what the job needs besides, including what verification will keep. Once, after ReserveMesh.
  absl::Status ReserveJob(const JobEstimate& estimate);

  // For more bricks that verification keeps. What ReserveJob reserved for them is used first.
  absl::Status ReserveKept(uint64_t bricks);

  // Gives everything back.
  void Free();

 private:
  uint64_t BytesOf(uint64_t triangles, uint64_t vertices) const;
  uint64_t BytesOfSolid(double line_crossings) const;
  uint64_t BytesOfThinning(const JobEstimate& estimate) const;

  const VoxelRequest& request_;
  const uint64_t threads_;
  MemoryReservation memory_;
  uint64_t job_bytes_ = 0, kept_bytes_ = 0;  // of memory_, by what they are for
};

}  // namespace latvox

#endif  // LATVOX_SERVER_WORK_JOB_MEMORY_H_
