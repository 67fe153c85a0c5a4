// The pipeline: mesh -> lattice coordinates -> tiles -> bricks.
#ifndef LATVOX_CORE_VOXELIZER_VOXELIZER_H_
#define LATVOX_CORE_VOXELIZER_VOXELIZER_H_

#include <functional>
#include <memory>
#include <optional>

#include "absl/status/statusor.h"
#include "core/band/band.h"
#include "core/base/stop_signal.h"
#include "core/brick/brick.h"
#include "core/lattice/grid.h"
#include "core/mesh/mesh.h"
#include "core/request/algorithm.h"
#include "core/solid/solid.h"
#include "core/verify/verify.h"
#include "core/voxelizer/digest.h"

namespace latvox {

// How finely to sample: nothing (the lattice as it is), a voxel size, or voxels along the longest side of the mesh.
struct Density {
  std::optional<double> voxel_size = std::nullopt;  // world units, finite, > 0
  std::optional<uint32_t> resolution =
      std::nullopt;  // 2 .. kMaxResolution; voxel_size = longest side / (resolution - 1)
};

inline constexpr uint32_t kMaxResolution = 65536;

// The grid for a mesh with these bounds. Without an origin, lattice point 0 is the bounds' low corner.
// Errors: INVALID_ARGUMENT naming field, value and limit.
absl::StatusOr<Grid> ResolveGrid(const Lattice& lattice, const Density& density, const std::optional<Vec3d>& origin,
                                 const Bounds& bounds);

// The index-th of `count` parts of a job that cost about the same: tiles that follow each other in the canonical order.
struct Shard {
  uint32_t index = 0, count = 1;  // index < count <= kMaxShards
};

inline constexpr uint32_t kMaxShards = 1 << 20;

struct VoxelizeOptions {
  int separability = 0;                           // k: 0, 1 or 2
  bool minimal = true;                            // thin to k-minimality; only kExact does, and no supercover is
  std::optional<IndexBox> region = std::nullopt;  // only these voxels, as they are in the whole
  std::optional<Bounds> bounds = std::nullopt;    // and only those within this box of the world: see WorldBox
  Algorithm algorithm = Algorithm::kExact;
  std::optional<Shard> shard = std::nullopt;         // only this part of them
  std::optional<Vec3i> resume_after = std::nullopt;  // tile_ijk: this tile and all before it are left out
  std::optional<Solid> solid = std::nullopt;         // the interior, too; kExact only
  Cover cover = Cover::kSeparating;                  // of kExact; a supercover is the same for every separability
  // Lattice points near the surface, with distances, instead of voxels that separate. Needs separability 0 and kExact.
  std::optional<Band> band = std::nullopt;
  // How many attributes the mesh has, and voxels are to carry: see core/attributes/attributes.h. Up to kMaxAttributes;
  // with any, kExact only, and neither solid nor band.
  uint32_t attributes = 0;
};

struct JobFacts {
  uint64_t triangles = 0, vertices = 0, degenerate_triangles = 0;
  bool closed = false;                               // every edge, by snapped position, in an even number of triangles
  double snap_error_max = 0;                         // voxels, per lattice coordinate
  std::optional<IndexBox> index_box = std::nullopt;  // no voxel lies outside; nullopt: no voxel at all
  bool cut_by_bounds = false;                        // options.bounds may leave out voxels of the whole
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
// the whole set.
class VoxelizeJob {
 public:
  // Snaps the mesh, and states its facts. Of a fine one, whose triangles are smaller than voxels, the edges that these
  // cross are found by the same pass, most of the work; they are kept from then on. Errors: INVALID_ARGUMENT naming
  // field, value and limit: mesh (see CheckMesh), extent, position, separability, region, bounds, shard, resume_after,
  // solid, band, cover, attributes (each with another algorithm than kExact), basis (of a supercover; see IntegerCell).
  // Also CANCELLED, soon, once `stop` is stopped, which concerns Create alone.
  static absl::StatusOr<std::unique_ptr<VoxelizeJob>> Create(TriangleMesh mesh, const Grid& grid,
                                                             const VoxelizeOptions& options, StopSignal stop = {});
  // The same of a mesh that was validated as it came: CheckMesh takes a tenth of the time of a job with fine triangles.
  // The job takes the mesh over, for its memory; or it shares the mesh with others, and copies its attributes alone.
  // Precondition: CheckMesh(mesh) is OK, unless cancelled.
  static absl::StatusOr<std::unique_ptr<VoxelizeJob>> CreateFromValid(TriangleMesh mesh, const Grid& grid,
                                                                      const VoxelizeOptions& options,
                                                                      StopSignal stop = {});
  static absl::StatusOr<std::unique_ptr<VoxelizeJob>> CreateFromValid(std::shared_ptr<const TriangleMesh> mesh,
                                                                      const Grid& grid, const VoxelizeOptions& options,
                                                                      StopSignal stop = {});
  virtual ~VoxelizeJob() = default;

  virtual const JobFacts& facts() const = 0;

  // Does what comes before the first tile and takes its time: of a solid, finding out whether the mesh has an inside.
  // Advance does it if nobody did before.
  // Errors: INVALID_ARGUMENT if that has none and options.solid does not force it; CANCELLED.
  virtual absl::Status Prepare() { return absl::OkStatus(); }

  // Receives one tile; returns false to pause. Called from one thread at a time.
  using Sink = std::function<bool(TileBricks&&)>;

  // Computes further tiles and hands them to `sink` until all are done (true) or the sink paused (false; a few more
  // tiles may follow the pause). Errors: CANCELLED after Cancel.
  virtual absl::StatusOr<bool> Advance(const Sink& sink) = 0;

  // What the sink has received so far.
  virtual const JobTotals& totals() const = 0;

  // Counts tunnels and redundant voxels of `voxels` for this job's mesh and separability, without tiles or thinning.
  // Precondition: none of options.region, bounds, shard and band was set. Errors: CANCELLED.
  virtual absl::StatusOr<Verdict> Verify(const VoxelSet& voxels) const = 0;

  // Makes Advance and Verify return CANCELLED soon. Any thread, any time.
  virtual void Cancel() = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_VOXELIZER_H_
