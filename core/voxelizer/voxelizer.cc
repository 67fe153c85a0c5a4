#include "core/voxelizer/voxelizer.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/attributes/attributes.h"
#include "core/attributes/plan.h"
#include "core/base/status_payload.h"
#include "core/block/tile_job.h"
#include "core/brick/tile_order.h"
#include "core/snap/snap.h"
#include "core/thesis/thesis.h"
#include "core/voxelizer/exact_job.h"
#include "core/voxelizer/job_facts.h"
#include "core/voxelizer/shard.h"
#include "core/voxelizer/thesis_job.h"
#include "core/voxelizer/world_box.h"

namespace latvox {
namespace {

absl::Status Cancelled() { return absl::CancelledError("voxelization cancelled"); }

IndexBox Moved(const IndexBox& box, const Vec3i& by) { return {box.min + by, box.max + by}; }

// Null if it is not asked for.
absl::StatusOr<std::unique_ptr<const Supercover>> SupercoverFor(const Lattice& lattice,
                                                                const VoxelizeOptions& options) {
  if (options.cover != Cover::kSupercover) return nullptr;
  if (options.algorithm != Algorithm::kExact) {
    return absl::InvalidArgumentError(
        absl::StrFormat("cover: supercover not together with algorithm %s", NameOf(options.algorithm)));
  }
  auto cell = IntegerCell::Of(lattice);
  if (!cell.ok()) return cell.status();
  return std::make_unique<const Supercover>(*cell);
}

absl::Status OutOfRange(const char* field, double value, const char* limit) {
  return absl::InvalidArgumentError(absl::StrFormat("%s: %g is not %s", field, value, limit));
}

absl::Status CheckPart(const VoxelizeOptions& options) {
  if (options.region && IsEmpty(*options.region)) {
    return absl::InvalidArgumentError("region: min is not below max on every axis");
  }
  for (size_t m = 0; options.bounds && m < 3; ++m) {
    const double low = options.bounds->min[m], high = options.bounds->max[m];
    if (std::isfinite(low) && std::isfinite(high) && low <= high) continue;
    return absl::InvalidArgumentError(absl::StrFormat(
        "bounds: %g to %g on axis %c are not finite numbers, the first no more than the other", low, high, "xyz"[m]));
  }
  if (options.shard && (options.shard->index >= options.shard->count || options.shard->count > kMaxShards)) {
    return absl::InvalidArgumentError(absl::StrFormat("shard: %d of %d is not one of at most %d", options.shard->index,
                                                      options.shard->count, kMaxShards));
  }
  return absl::OkStatus();
}

// The box of local voxels that the options leave; an empty one may lie anywhere.
IndexBox RegionOf(const SnappedMesh& mesh, const VoxelizeOptions& options, const std::optional<WorldBox>& bounds) {
  IndexBox part = Moved(mesh.box, mesh.base_ijk);
  if (options.region) part = Intersection(*options.region, part);
  if (bounds && !IsEmpty(part)) part = bounds->Around(part);
  return IsEmpty(part) ? IndexBox{} : Moved(part, -mesh.base_ijk);
}

// Nullopt: no band is asked for.
absl::StatusOr<std::optional<BandPlan>> PlanOfBand(const VoxelizeOptions& options, const Lattice& lattice) {
  if (!options.band) return std::nullopt;
  if (options.algorithm != Algorithm::kExact) {
    return absl::InvalidArgumentError(
        absl::StrFormat("band: not together with the algorithm %s", NameOf(options.algorithm)));
  }
  if (options.solid) return absl::InvalidArgumentError("band: not together with solid");
  if (options.cover != Cover::kSeparating) {
    return absl::InvalidArgumentError(absl::StrFormat("band: not together with cover %s", NameOf(options.cover)));
  }
  if (options.separability != 0) {
    return absl::InvalidArgumentError(
        absl::StrFormat("band: not together with a separability, here %d", options.separability));
  }
  return MakeBandPlan(*options.band, lattice);
}

absl::Status CheckAttributes(const TriangleMesh& mesh, const VoxelizeOptions& options) {
  const auto refuse = [](auto... words) { return absl::InvalidArgumentError(absl::StrCat("attributes: ", words...)); };
  if (options.attributes == 0) return absl::OkStatus();
  if (options.attributes > kMaxAttributes) return refuse(options.attributes, " exceed ", kMaxAttributes);
  if (mesh.attributes.size() != mesh.vertices.size() * options.attributes) {
    return refuse("the mesh has ", mesh.attributes.size(), " for ", mesh.vertices.size(), " vertices, not ",
                  options.attributes, " each");
  }
  if (options.algorithm != Algorithm::kExact) {
    return refuse("not together with the algorithm ", std::string{NameOf(options.algorithm)});
  }
  if (options.solid) return refuse("not together with solid, whose inside no triangle is near to");
  if (options.band) return refuse("not together with band");
  return absl::OkStatus();
}

// Nullopt: none are asked for.
absl::StatusOr<std::optional<CarriedAttributes>> MakeAttributes(std::vector<uint32_t> of_vertices,
                                                                const Lattice& lattice,
                                                                const VoxelizeOptions& options) {
  if (options.attributes == 0) return std::nullopt;
  auto plan = MakeAttributePlan(lattice, lattice.frames(options.separability), options.cover == Cover::kSupercover);
  if (!plan.ok()) return plan.status();
  return CarriedAttributes{*std::move(plan), options.attributes, std::move(of_vertices)};
}

const TriangleMesh& MeshOf(const TriangleMesh& mesh) { return mesh; }
const TriangleMesh& MeshOf(const std::shared_ptr<const TriangleMesh>& mesh) { return *mesh; }

std::vector<uint32_t> AttributesOf(TriangleMesh& mesh) { return std::exchange(mesh.attributes, {}); }
std::vector<uint32_t> AttributesOf(const std::shared_ptr<const TriangleMesh>& mesh) { return mesh->attributes; }

//   Mesh   a TriangleMesh, or shared
template <class Mesh>
absl::StatusOr<std::unique_ptr<VoxelizeJob>> MakeJob(Mesh mesh, const Grid& grid, const VoxelizeOptions& options,
                                                     StopSignal stop) {
  if (options.separability < 0 || options.separability > 2) {
    return OutOfRange("separability", options.separability, "0, 1 or 2");
  }
  if (absl::Status status = CheckPart(options); !status.ok()) return status;
  if (options.solid && options.algorithm != Algorithm::kExact) {
    return absl::InvalidArgumentError(
        absl::StrFormat("solid: not with the algorithm %s, but with exact", NameOf(options.algorithm)));
  }
  const absl::StatusOr<std::optional<BandPlan>> band = PlanOfBand(options, grid.lattice);
  if (!band.ok()) return band.status();
  if (auto status = CheckAttributes(MeshOf(mesh), options); !status.ok()) return status;
  auto attributes = MakeAttributes(AttributesOf(mesh), grid.lattice, options);
  if (!attributes.ok()) return attributes.status();
  const std::vector<Frame>& frames = grid.lattice.frames(options.separability);
  const bool exact = options.algorithm == Algorithm::kExact;
  auto supercover = SupercoverFor(grid.lattice, options);
  if (!supercover.ok()) return supercover.status();
  const Vec3i reach = *band         ? (*band)->reach * 2  // the box is for half of a neighbour's step
                      : *supercover ? (*supercover)->Reach()
                      : exact       ? ReachOf(frames)
                                    : ThesisReach(grid.lattice, options.separability, options.algorithm);
  auto snapped = Snap(std::move(mesh), grid.lattice, grid.origin, reach, stop);
  if (stop.Stopped()) return Cancelled();
  if (!snapped.ok()) return snapped.status();
  std::optional<WorldBox> bounds;
  if (options.bounds) bounds.emplace(grid, *options.bounds);
  const IndexBox region = RegionOf(*snapped, options, bounds);
  if (options.resume_after && !HasTile(Moved(region, snapped->base_ijk), *options.resume_after)) {
    const auto& [i, j, k] = *options.resume_after;
    const std::string tile = absl::StrFormat("%d,%d,%d", i, j, k);
    return WithValue(
        absl::InvalidArgumentError(absl::StrFormat("resume_after: tile %s does not meet the index box", tile)), tile);
  }
  std::unique_ptr<VoxelizeJob> job;
  if (exact) {
    auto plan = MakeExactPlan(
        {*std::move(snapped), frames, *std::move(supercover), *band, *std::move(attributes), region, bounds}, options,
        stop);
    if (!plan.ok()) return plan.status();
    job = MakeExactJob(*std::move(plan));
  } else {
    job = MakeThesisJob(*std::move(snapped), grid.lattice, options, region, bounds, stop);
  }
  if (stop.Stopped()) return Cancelled();
  return job;
}

// Adds each brick with its part of the values, of which there are `each` for a voxel.
template <class T>
void AddValues(const TileBricks& tile, std::span<const T> values, size_t each, Digest& digest) {
  for (const Brick& brick : tile.bricks) {
    const size_t count = CountVoxels(brick.mask) * each;
    digest.Add(brick, values.first(count));
    values = values.subspan(count);
  }
}

}  // namespace

void JobTotals::Add(const TileBricks& tile) {
  voxels += tile.voxels;
  bricks += tile.bricks.size();
  ++tiles;
  for (const Brick& brick : tile.bricks) digest.Add(brick);
  if (!tile.values.empty()) AddValues<float>(tile, tile.values, 1, values);
  if (!tile.attributes.empty())
    AddValues<uint32_t>(tile, tile.attributes, tile.attributes.size() / tile.voxels, attributes);
}

void JobTotals::Add(const JobTotals& other) {
  voxels += other.voxels;
  bricks += other.bricks;
  tiles += other.tiles;
  digest.Add(other.digest);
  values.Add(other.values);
  attributes.Add(other.attributes);
}

absl::StatusOr<Grid> ResolveGrid(const Lattice& lattice, const Density& density, const std::optional<Vec3d>& origin,
                                 const Bounds& bounds) {
  std::optional<double> voxel_size = density.voxel_size;
  if (voxel_size && !(*voxel_size > 0 && std::isfinite(*voxel_size))) {
    return OutOfRange("voxel_size", *voxel_size, "a finite number above 0");
  }
  if (density.resolution) {
    if (voxel_size) return absl::InvalidArgumentError("resolution: not together with voxel_size");
    if (*density.resolution < 2 || *density.resolution > kMaxResolution) {
      return OutOfRange("resolution", *density.resolution, "within 2 to 65536");
    }
    voxel_size = bounds.LongestSide() / (*density.resolution - 1);
    if (!(*voxel_size > 0))
      return absl::InvalidArgumentError("resolution: the mesh is a single point; give voxel_size");
  }
  if (origin) {
    for (double x : *origin) {
      if (!std::isfinite(x)) return OutOfRange("origin", x, "a finite number");
    }
  }
  auto scaled = voxel_size ? lattice.Scaled(*voxel_size) : lattice;
  if (!scaled.ok()) {
    return WithValue(absl::InvalidArgumentError(
                         absl::StrFormat("voxel_size: at %g, %s", *voxel_size, std::string(scaled.status().message()))),
                     absl::StrFormat("%g", *voxel_size));
  }
  return Grid{*std::move(scaled), origin.value_or(bounds.min)};
}

absl::StatusOr<std::unique_ptr<VoxelizeJob>> VoxelizeJob::Create(TriangleMesh mesh, const Grid& grid,
                                                                 const VoxelizeOptions& options, StopSignal stop) {
  if (auto status = CheckMesh(mesh, stop); !status.ok()) return status;
  return CreateFromValid(std::move(mesh), grid, options, stop);
}

absl::StatusOr<std::unique_ptr<VoxelizeJob>> VoxelizeJob::CreateFromValid(TriangleMesh mesh, const Grid& grid,
                                                                          const VoxelizeOptions& options,
                                                                          StopSignal stop) {
  return MakeJob(std::move(mesh), grid, options, stop);
}

absl::StatusOr<std::unique_ptr<VoxelizeJob>> VoxelizeJob::CreateFromValid(std::shared_ptr<const TriangleMesh> mesh,
                                                                          const Grid& grid,
                                                                          const VoxelizeOptions& options,
                                                                          StopSignal stop) {
  return MakeJob(std::move(mesh), grid, options, stop);
}

}  // namespace latvox
