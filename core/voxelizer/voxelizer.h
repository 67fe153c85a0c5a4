// The pipeline: mesh -> lattice coordinates -> tiles -> bricks.
#ifndef LATVOX_CORE_VOXELIZER_VOXELIZER_H_
#define LATVOX_CORE_VOXELIZER_VOXELIZER_H_

#include <functional>
#include <memory>
#include <optional>

#include "absl/status/statusor.h"
#include "core/brick/brick.h"
#include "core/lattice/grid.h"
#include "core/mesh/mesh.h"
#include "core/request/grid_request.h"
#include "core/request/options.h"
#include "core/request/request.h"
#include "core/verify/verify.h"
#include "core/voxelizer/digest.h"

namespace latvox {

struct JobFacts {
  uint64_t triangles = 0, vertices = 0, degenerate_triangles = 0;
  bool closed = false;                               // every edge, by snapped position, in an even number of triangles
  double snap_error_max = 0;                         // voxels, per lattice coordinate
  std::optional<IndexBox> index_box = std::nullopt;  // no voxel lies outside; nullopt: no voxel at all
  bool cut_by_bounds = false;                        // part.bounds may leave out voxels of the whole
  uint64_t tiles_in_box = 0;                         // 64^3 tiles that meet index_box
  Vec3i first_tile_ijk{};                            // of the canonical order (core/brick/tile_order.h)
  uint64_t unbalanced_lines = 0;                     // of a solid, once prepared: see CountUnbalancedLines
  double band_width = 0;                             // world units; 0: there is no band

  // Whether the tile meets index_box.
  bool HasTile(const Vec3i& tile_ijk) const;
};

struct JobTotals {
  uint64_t voxels = 0, bricks = 0, tiles = 0;
  Digest digest;
  Digest values;      // of a band: of voxels and values
  Digest attributes;  // of voxels and attributes, if they carry any
  void Add(const TileBricks& tile);
  void Add(const JobTotals& other);
};

// One mesh being voxelized. Tiles come out in canonical order (see BrickBatch in the protocol), and are the same for
// any number of threads and any order of triangles.
//
// Threads: methods of one object must not run at the same time, except Cancel. Compute runs in the oneTBB arena of the
// calling thread. Memory: the snapped mesh, or a shared one and its snapped vertices, what Create keeps, and a bounded
// number of tiles; for the thesis's algorithms, which are jobs with the same promises (core/voxelizer/thesis_job.h),
// the whole set. Ended jobs leave up to 32 MiB of a process to later ones: see core/base/kept_memory.h.
class VoxelizeJob {
 public:
  // Snaps the mesh, and states its facts. Of a fine one, whose triangles are smaller than voxels, the edges that these
  // cross are found by the same pass, most of the work; they are kept from then on. Errors: INVALID_ARGUMENT naming
  // field, value and limit: those of MakeRequest; mesh (see CheckMesh), extent, position, resume_after, band (its width
  // on this lattice), attributes (that the mesh lacks), basis (of a supercover; see IntegerCell). Also CANCELLED, soon,
  // once `stop` is stopped, which concerns Create alone.
  static absl::StatusOr<std::unique_ptr<VoxelizeJob>> Create(TriangleMesh mesh, const Grid& grid,
                                                             const VoxelizeOptions& options, StopSignal stop = {});
  // The same of a request that keeps all rules, and of a mesh that was validated as it came: CheckMesh takes a tenth of
  // the time of a job with fine triangles. The job takes the mesh over, for its memory; or it shares the mesh with
  // others, and copies its attributes alone. Precondition: CheckMesh(mesh) is OK, unless stopped.
  static absl::StatusOr<std::unique_ptr<VoxelizeJob>> CreateFromValid(TriangleMesh mesh, const Grid& grid,
                                                                      const VoxelRequest& request,
                                                                      StopSignal stop = {});
  static absl::StatusOr<std::unique_ptr<VoxelizeJob>> CreateFromValid(std::shared_ptr<const TriangleMesh> mesh,
                                                                      const Grid& grid, const VoxelRequest& request,
                                                                      StopSignal stop = {});
  virtual ~VoxelizeJob() = default;

  virtual const JobFacts& facts() const = 0;

  // Does what comes before the first tile and takes its time: of a solid, finding out whether the mesh has an inside.
  // Advance does it if nobody did before.
  // Errors: INVALID_ARGUMENT if that has none and the request does not force it; CANCELLED.
  virtual absl::Status Prepare() { return absl::OkStatus(); }

  // Receives one tile; returns false to pause. Called from one thread at a time.
  using Sink = std::function<bool(TileBricks&&)>;

  // Computes further tiles and hands them to `sink` until all are done (true) or the sink paused (false; a few more
  // tiles may follow the pause). Errors: CANCELLED after Cancel.
  virtual absl::StatusOr<bool> Advance(const Sink& sink) = 0;

  // What the sink has received so far.
  virtual const JobTotals& totals() const = 0;

  // Counts tunnels and redundant voxels of `voxels` for this job's mesh and separability, without tiles or thinning.
  // Precondition: the request has no band, region, bounds or shard. Errors: CANCELLED.
  virtual absl::StatusOr<Verdict> Verify(const VoxelSet& voxels) const = 0;

  // Makes Advance and Verify return CANCELLED soon. Any thread, any time.
  virtual void Cancel() = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_VOXELIZER_H_
