#include "server/wire/answers.h"

#include <string>

#include "core/fields/link_order.h"
#include "core/snap/snap.h"
#include "server/wire/enums.h"
#include "server/wire/vectors.h"

namespace latvox {
namespace {

// Returns whether all shards together deliver every voxel that the surface can have. The box in `facts` is clipped to
// the region. So a box that touches the region's border may have been longer.
bool IsUncut(const Part& part, const JobFacts& facts) {
  if (facts.cut_by_bounds) return false;
  if (!part.region) return true;
  if (!facts.index_box) return false;
  for (size_t m = 0; m < 3; ++m) {
    if (facts.index_box->min[m] <= part.region->min[m] || facts.index_box->max[m] >= part.region->max[m]) {
      return false;
    }
  }
  return true;
}

void GridToProto(const Grid& grid, Placement placement, v1::Grid& out) {
  const Mat3d& basis = grid.lattice.basis();
  ToProto(basis[0], *out.mutable_basis()->mutable_a());
  ToProto(basis[1], *out.mutable_basis()->mutable_b());
  ToProto(basis[2], *out.mutable_basis()->mutable_c());
  ToProto(grid.origin, *out.mutable_origin());
  out.set_voxel_size(grid.lattice.voxel_size());
  out.set_placement(static_cast<v1::Placement>(NumberOf(kPlacementNumbers, placement)));
}

void MeshFactsToProto(const JobFacts& facts, const MeshSource& source, v1::MeshFacts& out) {
  out.set_triangles(facts.triangles);
  out.set_vertices(facts.vertices);
  out.set_degenerate_triangles(facts.degenerate_triangles);
  out.set_closed(facts.closed);
  out.set_quantization_bits(source.quantization_bits);
  out.set_snap_error_max(facts.snap_error_max);
  ToProto(source.bounds.min, *out.mutable_min());
  ToProto(source.bounds.max, *out.mutable_max());
}

// Claims about the surface in a set. The exact algorithm keeps them by construction; another algorithm keeps them if
// counting found no fault.
void ClaimsToProto(const VoxelRequest& request, const JobFacts& facts, const std::optional<Verdict>& verdict,
                   v1::Certificate& out) {
  const bool is_exact = request.algorithm() == Algorithm::kExact;
  if (!is_exact) {
    const bool is_minimal = verdict && verdict->tunnels == 0 && verdict->redundant == 0;
    out.set_tunnel_free(verdict && verdict->tunnels == 0);
    out.set_minimal(is_minimal);
    out.set_whole_minimal(is_minimal);
    return;
  }
  const bool has_surface = request.has_surface();
  const bool one_of_several = request.part.shard && request.part.shard->count > 1;
  const bool is_minimal = has_surface && request.is_minimal(), uncut = IsUncut(request.part, facts);
  out.set_tunnel_free(has_surface);
  out.set_whole_minimal(is_minimal && (uncut || !one_of_several));
  out.set_minimal(is_minimal && uncut && !one_of_several);
}

void LeakToProto(const Leak& leak, v1::Leak& out) {
  constexpr v1::LeakKind kKinds[] = {v1::LEAK_KIND_NONE, v1::LEAK_KIND_IN_SURFACE, v1::LEAK_KIND_FOUND,
                                     v1::LEAK_KIND_BOX_TOO_LARGE};
  out.set_kind(kKinds[leak.kind]);
  ToProto(leak.from, *out.mutable_from());
  out.set_box_points(leak.box_points);
  if (leak.kind != Leak::kFound) return;
  out.set_steps(leak.steps);
  for (const Vec3i& ijk : leak.path) ToProto(ijk, *out.add_path());
  ToProto(leak.narrowest, *out.mutable_narrowest());
  ToProto(leak.narrowest_world, *out.mutable_narrowest_world());
  out.set_room(leak.room);
}

void WalkToProto(const WalkFacts& walk, v1::WalkFacts& out) {
  out.set_cavities(walk.cavities);
  for (const uint64_t points : walk.largest) out.add_largest_cavities(points);
  if (walk.leak) LeakToProto(*walk.leak, *out.mutable_leak());
  for (const LabelWalkFacts& facts : walk.labels) {
    v1::LabelWalk& of_label = *out.add_labels();
    of_label.set_label(facts.label);
    of_label.set_cavities(facts.cavities);
    of_label.set_points(facts.points);
    if (facts.leak) LeakToProto(*facts.leak, *of_label.mutable_leak());
  }
}

// A field without a tile has the digest of nothing.
void FieldsToProto(const FieldList& fields, const JobTotals& totals, v1::Certificate& out) {
  for (size_t n = 0; n < fields.size(); ++n) {
    v1::FieldCertificate& field = *out.add_fields();
    field.set_field(static_cast<v1::Field>(NumberOf(kFieldNumbers, fields.view()[n])));
    field.set_digest((n < totals.fields.size() ? totals.fields[n] : Digest()).ToHex());
  }
}

}  // namespace

v1::Accepted AcceptedToProto(const std::string& request_id, const VoxelRequest& request, const Grid& grid,
                             Placement placement, const JobFacts& facts, const MeshSource& source) {
  v1::Accepted accepted;
  accepted.set_request_id(request_id);
  GridToProto(grid, placement, *accepted.mutable_grid());
  if (facts.index_box) {
    ToProto(facts.index_box->min, *accepted.mutable_index_box()->mutable_min());
    ToProto(facts.index_box->max, *accepted.mutable_index_box()->mutable_max());
  }
  accepted.set_tiles_in_box(facts.tiles_in_box);
  MeshFactsToProto(facts, source, *accepted.mutable_mesh());
  for (const uint32_t label : facts.fraction_labels) accepted.add_fraction_labels(label);
  if (request.fields.OfLinks().empty()) return accepted;
  for (const Vec3i& q : NeighborsOf(grid.lattice.frames(request.separability))) ToProto(q, *accepted.add_neighbors());
  return accepted;
}

v1::Certificate CertificateToProto(const JobSpec& spec, const JobFacts& facts, const MeshSource& source,
                                   const JobTotals& totals, const std::optional<Verdict>& verdict) {
  const VoxelRequest& request = spec.request;
  v1::Certificate certificate;
  certificate.set_lattice(std::string{spec.grid.lattice.name()});
  certificate.set_separability(static_cast<uint32_t>(request.separability));
  ClaimsToProto(request, facts, verdict, certificate);
  const Verdict counted = verdict.value_or(Verdict{});
  certificate.set_verified(verdict.has_value());
  certificate.set_tunnels(counted.tunnels);
  certificate.set_redundant(counted.redundant);
  certificate.set_closed(facts.closed);
  certificate.set_snap_error_max(facts.snap_error_max);
  certificate.set_quantization_bits(source.quantization_bits);
  certificate.set_algorithm(std::string{NameOf(request.algorithm())});
  certificate.set_set(std::string{NameOfSet(request)});
  certificate.set_version(LATVOX_VERSION);
  certificate.set_digest(totals.digest.ToHex());
  if (const auto& shard = request.part.shard) {
    certificate.mutable_shard()->set_index(shard->index);
    certificate.mutable_shard()->set_count(shard->count);
  }
  if (request.solid() != nullptr) {
    certificate.mutable_solid()->set_rule(std::string{NameOf(facts.interior_rule)});
    certificate.mutable_solid()->set_unbalanced_lines(facts.unbalanced_lines);
  }
  if (request.needs_inside() && request.solid() == nullptr) {
    certificate.set_interior_rule(std::string{NameOf(facts.interior_rule)});
  }
  if (facts.walk) WalkToProto(*facts.walk, *certificate.mutable_walk());
  if (request.band() != nullptr) certificate.mutable_band()->set_width(facts.band_width);
  FieldsToProto(request.fields, totals, certificate);
  certificate.set_signed_distance(request.signed_distance);
  certificate.set_fraction_n(request.fraction_n);
  for (const uint32_t label : facts.fraction_labels) certificate.add_fraction_labels(label);
  return certificate;
}

v1::GetLimitsResponse LimitsToProto(const Limits& limits, const BuildFacts& build) {
  v1::GetLimitsResponse response;
  response.set_max_mesh_bytes(limits.max_mesh_bytes);
  response.set_max_triangles(limits.max_triangles);
  response.set_max_vertices(limits.max_vertices);
  response.set_max_extent(kMaxExtent);
  response.set_max_jobs(limits.max_jobs);
  response.set_max_message_bytes(limits.max_message_bytes);
  response.set_subvoxel_bits(kSubvoxelBits);
  response.set_version(LATVOX_VERSION);
  response.set_max_points(limits.max_points());
  response.set_max_crossings(limits.max_crossings());
  response.set_max_pixels(limits.max_pixels());
  response.set_max_queued_jobs(limits.max_queued_jobs);
  response.set_max_jobs_per_client(limits.max_jobs_per_client);
  response.set_memory_budget_bytes(limits.memory_budget_bytes);
  response.set_mesh_store_bytes(limits.mesh_store_bytes);
  response.set_max_visited_points(limits.max_visited_points);
  response.set_max_job_seconds(absl::ToDoubleSeconds(limits.max_job_time));
  response.set_commit(build.commit);
  for (const auto& [name, version] : build.libraries) {
    v1::Library& library = *response.add_libraries();
    library.set_name(name);
    library.set_version(version);
  }
  return response;
}

}  // namespace latvox
