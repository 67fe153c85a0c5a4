// Limits that a request must keep before it costs much.
#ifndef LATVOX_SERVER_BASE_LIMITS_H_
#define LATVOX_SERVER_BASE_LIMITS_H_

#include <algorithm>
#include <cstdint>

#include "absl/time/time.h"

namespace latvox {

struct Limits {
  uint64_t max_mesh_bytes = uint64_t{1} << 30;       // encoded mesh
  uint64_t max_triangles = uint64_t{64} << 20;       // in one mesh
  uint64_t max_vertices = uint64_t{64} << 20;        // points in one mesh, as the codec counts them
  uint32_t max_jobs = 16;                            // at work at once
  uint32_t max_queued_jobs = 256;                    // that send their input, wait for their turn, or are paused
  uint32_t max_jobs_per_client = 128;                // at work or queued, for one client
  uint64_t max_visited_points = uint64_t{1} << 36;   // that one job looks at, as EstimateVisits counts them
  absl::Duration max_job_time = absl::Hours(1);      // of CPUs, that one job takes
  uint64_t memory_budget_bytes = uint64_t{4} << 30;  // of all jobs together
  uint64_t mesh_store_bytes = uint64_t{256} << 20;   // meshes kept for later requests, encoded and decoded
  uint64_t max_message_bytes = uint64_t{4} << 20;    // one message of a request

  // The limit for gRPC. It is a little larger, so that the server itself refuses most messages that are too large, and
  // names the limit. gRPC has no details for such an error.
  uint64_t received_message_bytes() const {
    constexpr uint64_t kMost = INT32_MAX, kLeastMore = uint64_t{4} << 20;
    const uint64_t bytes = std::min(max_message_bytes, kMost);
    return std::min(bytes + std::max(bytes, kLeastMore), kMost);
  }

  // The limits of Pixelize follow from its one message each way.
  //
  // Points in all polylines. One takes 16 bytes, and 6 more if it is a polyline of its own. The rest of the room makes
  // sure that the server refuses more points by name, instead of gRPC refusing the message.
  uint64_t max_points() const { return max_message_bytes / 32; }
  // Pixels in the answer. A pixel has two integers of up to 5 bytes each, and the answer a few hundred bytes more.
  uint64_t max_pixels() const { return (std::max<uint64_t>(max_message_bytes, 1024) - 1024) / 10; }
  // Crossings of segments with lattice links, which take 24 bytes each. A curve that does not cover itself has up to
  // four for each pixel; the rest is for curves that do.
  uint64_t max_crossings() const { return 16 * max_pixels(); }
};

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_LIMITS_H_
