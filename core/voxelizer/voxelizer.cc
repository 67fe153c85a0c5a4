#include "core/voxelizer/voxelizer.h"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/status_payload.h"
#include "core/block/tile_job.h"
#include "core/brick/tile_order.h"
#include "core/fields/plan.h"
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

// Null unless the request asks for a supercover.
absl::StatusOr<std::unique_ptr<const Supercover>> SupercoverFor(const Lattice& lattice, const VoxelRequest& request) {
  if (!request.is_supercover()) return nullptr;
  auto cell = IntegerCell::Of(lattice);
  if (!cell.ok()) return cell.status();
  return std::make_unique<const Supercover>(*cell);
}

// The box of local voxels that the request keeps; an empty one may lie anywhere.
IndexBox RegionOf(const SnappedMesh& mesh, const Part& part, const std::optional<WorldBox>& bounds) {
  IndexBox box = Moved(mesh.box, mesh.base_ijk);
  if (part.region) box = Intersection(*part.region, box);
  if (bounds && !IsEmpty(box)) box = bounds->Around(box);
  return IsEmpty(box) ? IndexBox{} : Moved(box, -mesh.base_ijk);
}

// Nullopt unless the request asks for a band.
absl::StatusOr<std::optional<BandPlan>> PlanOfBand(const VoxelRequest& request, const Lattice& lattice) {
  if (request.band() == nullptr) return std::nullopt;
  return MakeBandPlan(*request.band(), lattice);
}

// Nullopt unless a walk decides on the set.
absl::StatusOr<std::optional<WalkPlan>> PlanOfWalk(const VoxelRequest& request, const Grid& grid, StopSignal stop) {
  if (request.walk() == nullptr) return std::nullopt;
  return MakeWalkPlan(*request.walk(), grid, grid.lattice.frames(request.separability), stop);
}

absl::Status CheckFieldsOf(const TriangleMesh& mesh, const FieldList& of_mesh) {
  if (mesh.attributes.size() == mesh.vertex_count() * of_mesh.size()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("fields: the mesh has ", mesh.attributes.size(), " numbers for ",
                                                 mesh.vertex_count(), " vertices, not ", of_mesh.size(), " each"));
}

// Nullopt if voxels carry no field.
absl::StatusOr<std::optional<FieldPlan>> PlanOfFields(std::vector<uint32_t> of_vertices, const Lattice& lattice,
                                                      const VoxelRequest& request) {
  if (request.fields.empty()) return std::nullopt;
  return MakeFieldPlan(request, lattice, std::move(of_vertices));
}

absl::Status CheckResumePoint(const VoxelRequest& request, const IndexBox& box) {
  if (!request.part.resume_after || HasTile(box, *request.part.resume_after)) return absl::OkStatus();
  const auto& [i, j, k] = *request.part.resume_after;
  const std::string tile = absl::StrFormat("%d,%d,%d", i, j, k);
  return WithValue(
      absl::InvalidArgumentError(absl::StrFormat("resume_after: tile %s does not meet the index box", tile)), tile);
}

const TriangleMesh& MeshOf(const TriangleMesh& mesh) { return mesh; }
const TriangleMesh& MeshOf(const std::shared_ptr<const TriangleMesh>& mesh) { return *mesh; }

std::vector<uint32_t> AttributesOf(TriangleMesh& mesh) { return std::exchange(mesh.attributes, {}); }
std::vector<uint32_t> AttributesOf(const std::shared_ptr<const TriangleMesh>& mesh) { return mesh->attributes; }

//   Mesh   a TriangleMesh, or shared
template <class Mesh>
absl::StatusOr<std::unique_ptr<VoxelizeJob>> MakeJob(Mesh mesh, const Grid& grid, const VoxelRequest& request,
                                                     StopSignal stop) {
  const absl::StatusOr<std::optional<BandPlan>> band = PlanOfBand(request, grid.lattice);
  if (!band.ok()) return band.status();
  absl::StatusOr<std::optional<WalkPlan>> walk = PlanOfWalk(request, grid, stop);
  if (!walk.ok()) return walk.status();
  const FieldList of_mesh = request.fields.OfMesh();
  if (auto status = CheckFieldsOf(MeshOf(mesh), of_mesh); !status.ok() && !of_mesh.empty()) return status;
  auto fields = PlanOfFields(AttributesOf(mesh), grid.lattice, request);
  if (!fields.ok()) return fields.status();
  auto supercover = SupercoverFor(grid.lattice, request);
  if (!supercover.ok()) return supercover.status();
  const std::vector<Frame>& frames = grid.lattice.frames(request.separability);
  const bool exact = request.algorithm() == Algorithm::kExact;
  const Vec3i reach = *band                        ? (*band)->reach * 2  // the box covers half a neighbor's step
                      : *walk                      ? ReachOf(**walk)
                      : *supercover                ? (*supercover)->Reach()
                      : request.links() != nullptr ? ReachOf(frames) * 2
                      : exact                      ? ReachOf(frames)
                              : ThesisReach(grid.lattice, request.separability, request.algorithm());
  auto snapped = Snap(std::move(mesh), grid.lattice, grid.origin, reach, stop);
  if (stop.Stopped()) return Cancelled();
  if (!snapped.ok()) return snapped.status();
  std::optional<WorldBox> bounds;
  if (request.part.bounds) bounds.emplace(grid, *request.part.bounds);
  const IndexBox region = RegionOf(*snapped, request.part, bounds);
  if (auto status = CheckResumePoint(request, Moved(region, snapped->base_ijk)); !status.ok()) return status;
  std::unique_ptr<VoxelizeJob> job;
  if (*walk && (*walk)->start) (*walk)->start = *(*walk)->start - snapped->base_ijk;
  if (exact) {
    auto plan = MakeExactPlan({*std::move(snapped), frames, *std::move(supercover), *band, *std::move(walk),
                               *std::move(fields), region, bounds},
                              request, stop);
    if (!plan.ok()) return plan.status();
    job = MakeExactJob(*std::move(plan));
  } else {
    job = MakeThesisJob(*std::move(snapped), grid.lattice, request, region, bounds, stop);
  }
  if (stop.Stopped()) return Cancelled();
  return job;
}

// Adds each brick with its part of a field.
void AddField(const TileBricks& tile, std::span<const std::byte> values, Digest& digest) {
  const size_t bytes = values.size() / tile.voxels;
  for (const Brick& brick : tile.bricks) {
    const size_t count = CountVoxels(brick.mask) * bytes;
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
  fields.resize(tile.fields.size());
  for (size_t n = 0; n < fields.size(); ++n) AddField(tile, tile.fields[n], fields[n]);
}

void JobTotals::Add(const JobTotals& other) {
  voxels += other.voxels;
  bricks += other.bricks;
  tiles += other.tiles;
  digest.Add(other.digest);
  fields.resize(std::max(fields.size(), other.fields.size()));
  for (size_t n = 0; n < other.fields.size(); ++n) fields[n].Add(other.fields[n]);
}

absl::StatusOr<std::unique_ptr<VoxelizeJob>> VoxelizeJob::Create(TriangleMesh mesh, const Grid& grid,
                                                                 const VoxelizeOptions& options, StopSignal stop) {
  const absl::StatusOr<VoxelRequest> request = MakeRequest(options);
  if (!request.ok()) return request.status();
  if (auto status = CheckMesh(mesh, stop); !status.ok()) return status;
  return CreateFromValid(std::move(mesh), grid, *request, stop);
}

absl::StatusOr<std::unique_ptr<VoxelizeJob>> VoxelizeJob::CreateFromValid(TriangleMesh mesh, const Grid& grid,
                                                                          const VoxelRequest& request,
                                                                          StopSignal stop) {
  return MakeJob(std::move(mesh), grid, request, stop);
}

absl::StatusOr<std::unique_ptr<VoxelizeJob>> VoxelizeJob::CreateFromValid(std::shared_ptr<const TriangleMesh> mesh,
                                                                          const Grid& grid, const VoxelRequest& request,
                                                                          StopSignal stop) {
  return MakeJob(std::move(mesh), grid, request, stop);
}

}  // namespace latvox
