// The pipeline: mesh -> lattice coordinates -> tiles -> bricks.
#ifndef LATVOX_CORE_VOXELIZER_VOXELIZER_H_
#define LATVOX_CORE_VOXELIZER_VOXELIZER_H_

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/brick/brick.h"
#include "core/lattice/grid.h"
#include "core/mesh/mesh.h"
#include "core/request/grid_request.h"
#include "core/request/options.h"
#include "core/request/request.h"
#include "core/verify/verify.h"
#include "core/voxelizer/digest.h"
#include "core/walk/facts.h"

namespace latvox {

struct JobFacts {
  uint64_t triangles = 0, vertices = 0, degenerate_triangles = 0;
  bool closed = false;        // every edge, by snapped position, belongs to an even number of triangles
  double snap_error_max = 0;  // voxels, per lattice coordinate
  std::optional<IndexBox> index_box = std::nullopt;  // no voxel lies outside; nullopt: no voxel at all
  bool cut_by_bounds = false;                        // part.bounds may leave out voxels of the whole
  uint64_t tiles_in_box = 0;                         // 64^3 tiles that meet index_box
  Vec3i first_tile_ijk{};                            // of the canonical order (core/brick/tile_order.h)
  // Where set or fields depend on the inside: the rule, never kAuto; for a solid, once prepared.
  InteriorRule interior_rule = InteriorRule::kAuto;
  uint64_t unbalanced_lines = 0;                 // for a solid, once prepared: see CountUnbalancedLines
  double band_width = 0;                         // world units; 0: there is no band
  std::optional<WalkFacts> walk = std::nullopt;  // for a set that a walk decides, once prepared
  std::vector<uint32_t> fraction_labels = {};    // those of Field::kLabelFractions

  // Whether the tile meets index_box.
  bool HasTile(const Vec3i& tile_ijk) const;
};

struct JobTotals {
  uint64_t voxels = 0, bricks = 0, tiles = 0;
  Digest digest;
  std::vector<Digest> fields;  // of voxels and each field of the request, in its order; empty without a tile
  void Add(const TileBricks& tile);
  void Add(const JobTotals& other);
};

// The voxelization of one mesh. Tiles come in canonical order (see BrickBatch in the protocol), and are the same for
// any number of threads and any order of triangles.
//
// Threads: methods of one object must not run at the same time, except Cancel, Interrupt and CpuSeconds. Compute runs
// in the oneTBB arena of the calling thread. Memory: the snapped mesh, or a shared one and its snapped vertices; the
// results of Create; and a bounded number of tiles. The thesis's algorithms (core/voxelizer/thesis_job.h) keep the same
// promises, but hold the whole set. Ended jobs leave up to 32 MiB of a process to later ones: see
// core/base/kept_memory.h.
class VoxelizeJob {
 public:
  // Snaps the mesh, and finds its facts. For a fine mesh, with triangles smaller than voxels, the same pass finds the
  // links that its triangles cross, or for a supercover the cells that they meet. It keeps them; that is most of the
  // work. Errors: INVALID_ARGUMENT naming field, value and limit: those of MakeRequest; mesh (see CheckMesh), extent,
  // position, resume_after, band (its width on this lattice), fields (that the mesh lacks), basis (for a supercover;
  // see IntegerCell). CANCELLED, soon, once `stop` is stopped, which does not stop the job.
  static absl::StatusOr<std::unique_ptr<VoxelizeJob>> Create(TriangleMesh mesh, const Grid& grid,
                                                             const VoxelizeOptions& options, StopSignal stop = {});
  // Does the same with a request that keeps all rules, and a mesh that was checked while it arrived. CheckMesh takes a
  // tenth of the time of a job with fine triangles. The job takes the mesh, to use its memory; or it shares the mesh
  // with others, and copies only its numbers for fields. Precondition: CheckMesh(mesh) is OK, unless stopped.
  static absl::StatusOr<std::unique_ptr<VoxelizeJob>> CreateFromValid(TriangleMesh mesh, const Grid& grid,
                                                                      const VoxelRequest& request,
                                                                      StopSignal stop = {});
  static absl::StatusOr<std::unique_ptr<VoxelizeJob>> CreateFromValid(std::shared_ptr<const TriangleMesh> mesh,
                                                                      const Grid& grid, const VoxelRequest& request,
                                                                      StopSignal stop = {});
  virtual ~VoxelizeJob() = default;

  virtual const JobFacts& facts() const = 0;

  // Does the long work before the first tile: for a solid, finds whether the mesh has an inside. Advance does it if
  // nobody has. Errors: INVALID_ARGUMENT if the mesh has no inside and the request does not force it; CANCELLED.
  virtual absl::Status Prepare() { return absl::OkStatus(); }

  // Receives one tile; returns false to pause. One thread calls it at a time.
  using Sink = std::function<bool(TileBricks&&)>;

  // Computes further tiles and gives them to `sink`, until all are done (true) or the sink has paused (false; a few
  // more tiles may follow the pause) or Interrupt was called. Errors: CANCELLED after Cancel.
  virtual absl::StatusOr<bool> Advance(const Sink& sink) = 0;

  // Totals of the tiles that the sink has received.
  virtual const JobTotals& totals() const = 0;

  // Counts tunnels and redundant voxels of `voxels` for this job's mesh and separability, without tiles or thinning.
  // Precondition: the request has no band, region, bounds or shard. Errors: CANCELLED.
  virtual absl::StatusOr<Verdict> Verify(const VoxelSet& voxels) const = 0;

  // Makes a running Advance return soon, even in the middle of a tile. The next one finds again what is lost. Calls at
  // other times have no effect. The thesis's algorithms go on. Any thread.
  virtual void Interrupt() {}

  // The CPU time so far, of all threads. While a thread waits for others, it may begin work of another job, which
  // counts for both. Any thread.
  virtual double CpuSeconds() const = 0;

  // Makes Advance and Verify return CANCELLED soon. Any thread, at any time.
  virtual void Cancel() = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_VOXELIZER_H_
