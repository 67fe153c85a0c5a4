#include "client/internal/wire.h"

#include <array>
#include <variant>

#include "client/internal/grpc_message.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

v1::Vector3 ToProto(const Vec3d& v) {
  v1::Vector3 out;
  out.set_x(v[0]);
  out.set_y(v[1]);
  out.set_z(v[2]);
  return out;
}

v1::Ijk ToProto(const Vec3i& v) {
  v1::Ijk out;
  out.set_i(v[0]);
  out.set_j(v[1]);
  out.set_k(v[2]);
  return out;
}

Vec3d FromProto(const v1::Vector3& v) { return {v.x(), v.y(), v.z()}; }
Shard FromProto(const v1::Shard& shard) { return {shard.index(), shard.count()}; }
Vec3i FromProto(const v1::Ijk& v) { return {v.i(), v.j(), v.k()}; }

static_assert(v1::NamedLattice_MAX == kNamedLattices.size());
v1::NamedLattice ToProto(NamedLattice lattice) { return static_cast<v1::NamedLattice>(static_cast<int>(lattice) + 1); }

v1::Algorithm ToProto(Algorithm algorithm) {
  switch (algorithm) {
    case Algorithm::kExact:
      return v1::ALGORITHM_EXACT;
    case Algorithm::kBruteForce:
      return v1::ALGORITHM_BRUTE_FORCE;
    case Algorithm::kIncremental:
      return v1::ALGORITHM_INCREMENTAL;
    case Algorithm::kOptimizedIncremental:
      return v1::ALGORITHM_OPTIMIZED_INCREMENTAL;
  }
  return v1::ALGORITHM_UNSPECIFIED;
}

v1::BrickEncoding ToProto(BrickEncoding encoding) {
  switch (encoding) {
    case BrickEncoding::kMasks:
      return v1::BRICK_ENCODING_MASKS;
    case BrickEncoding::kPacked:
      return v1::BRICK_ENCODING_PACKED;
    case BrickEncoding::kPackedZstd:
      return v1::BRICK_ENCODING_PACKED_ZSTD;
  }
  return v1::BRICK_ENCODING_UNSPECIFIED;
}

v1::InteriorRule ToProto(InteriorRule rule) {
  switch (rule) {
    case InteriorRule::kAuto:
      return v1::INTERIOR_RULE_UNSPECIFIED;
    case InteriorRule::kParity:
      return v1::INTERIOR_RULE_PARITY;
    case InteriorRule::kWinding:
      return v1::INTERIOR_RULE_WINDING;
    case InteriorRule::kPositive:
      return v1::INTERIOR_RULE_POSITIVE;
  }
  return v1::INTERIOR_RULE_UNSPECIFIED;
}

v1::SolidSurface ToProto(SolidSurface surface) {
  switch (surface) {
    case SolidSurface::kSeparating:
      return v1::SOLID_SURFACE_SEPARATING;
    case SolidSurface::kSupercover:
      return v1::SOLID_SURFACE_SUPERCOVER;
    case SolidSurface::kNone:
      return v1::SOLID_SURFACE_NONE;
  }
  return v1::SOLID_SURFACE_UNSPECIFIED;
}

// In the order of kFields.
constexpr std::array<v1::Field, kFields.size()> kFieldNumbers{
    v1::FIELD_PART,           v1::FIELD_MATERIAL,       v1::FIELD_COLOR,    v1::FIELD_DISTANCE,
    v1::FIELD_TRIANGLE,       v1::FIELD_POINT,          v1::FIELD_NORMAL,   v1::FIELD_LINKS,
    v1::FIELD_LINK_TRIANGLES, v1::FIELD_LINK_CROSSINGS, v1::FIELD_FRACTION, v1::FIELD_LABEL_FRACTIONS};
v1::Field ToProto(Field field) { return kFieldNumbers[static_cast<size_t>(field)]; }

void SetToProto(const Surface&, v1::VoxelizeSpec& spec) { spec.mutable_surface(); }
void SetToProto(const Supercover&, v1::VoxelizeSpec& spec) { spec.mutable_supercover(); }

template <class Set, class Message>
void LabelsToProto(const Set& set, Message& out) {
  if (set.labels) out.set_labels(ToProto(*set.labels));
  out.mutable_priority()->Add(set.priority.begin(), set.priority.end());
}

void SetToProto(const Solid& solid, v1::VoxelizeSpec& spec) {
  v1::Solid& out = *spec.mutable_solid();
  out.set_rule(ToProto(solid.rule));
  out.set_surface(ToProto(solid.surface));
  out.set_force_open(solid.force_open);
  LabelsToProto(solid, out);
}

void SetToProto(const Band& band, v1::VoxelizeSpec& spec) {
  band.in_voxels ? spec.mutable_band()->set_voxels(band.width) : spec.mutable_band()->set_width(band.width);
}

void SetToProto(const Links& links, v1::VoxelizeSpec& spec) {
  static_assert(v1::LINK_SIDE_BOTH == 1 && v1::LINK_SIDE_INSIDE == 2 && v1::LINK_SIDE_OUTSIDE == 3);
  spec.mutable_links()->set_side(static_cast<v1::LinkSide>(static_cast<int>(links.side) + 1));
}

void SetToProto(const Enclosed& enclosed, v1::VoxelizeSpec& spec) {
  v1::Enclosed& out = *spec.mutable_enclosed();
  out.set_surface(ToProto(enclosed.surface));
  out.set_close(enclosed.close);
  if (enclosed.leak_from) *out.mutable_leak_from() = ToProto(*enclosed.leak_from);
  LabelsToProto(enclosed, out);
}

void SetToProto(const Connected& connected, v1::VoxelizeSpec& spec) {
  v1::Connected& out = *spec.mutable_connected();
  *out.mutable_seed() = ToProto(connected.seed);
  out.set_close(connected.close);
  out.set_allow_outside(connected.allow_outside);
}

Leak FromProto(const v1::Leak& leak) {
  Leak out{.from = FromProto(leak.from()),
           .steps = leak.steps(),
           .path = {},
           .narrowest = FromProto(leak.narrowest()),
           .narrowest_world = FromProto(leak.narrowest_world()),
           .room = leak.room(),
           .box_points = leak.box_points()};
  if (leak.kind() == v1::LEAK_KIND_IN_SURFACE) out.kind = Leak::Kind::kInSurface;
  if (leak.kind() == v1::LEAK_KIND_FOUND) out.kind = Leak::Kind::kFound;
  if (leak.kind() == v1::LEAK_KIND_BOX_TOO_LARGE) out.kind = Leak::Kind::kBoxTooLarge;
  for (const v1::Ijk& ijk : leak.path()) out.path.push_back(FromProto(ijk));
  return out;
}

LabelWalk FromProto(const v1::LabelWalk& walk) {
  return {.label = walk.label(),
          .cavities = walk.cavities(),
          .points = walk.points(),
          .leak = walk.has_leak() ? std::optional(FromProto(walk.leak())) : std::nullopt};
}

WalkFacts FromProto(const v1::WalkFacts& walk) {
  WalkFacts out{.cavities = walk.cavities(),
                .largest_cavities = {walk.largest_cavities().begin(), walk.largest_cavities().end()},
                .leak = walk.has_leak() ? std::optional(FromProto(walk.leak())) : std::nullopt};
  for (const v1::LabelWalk& of_label : walk.labels()) out.labels.push_back(FromProto(of_label));
  return out;
}

// Unknown fields are left out.
std::vector<FieldCertificate> FieldsOf(const v1::Certificate& certificate) {
  std::vector<FieldCertificate> fields;
  for (const v1::FieldCertificate& field : certificate.fields()) {
    for (const FieldFacts& row : kFields) {
      if (field.field() == ToProto(row.field)) fields.push_back({row.field, field.digest()});
    }
  }
  return fields;
}

MeshFacts FromProto(const v1::MeshFacts& mesh) {
  return {.triangles = mesh.triangles(),
          .vertices = mesh.vertices(),
          .degenerate_triangles = mesh.degenerate_triangles(),
          .closed = mesh.closed(),
          .quantization_bits = mesh.quantization_bits(),
          .snap_error_max = mesh.snap_error_max(),
          .min = FromProto(mesh.min()),
          .max = FromProto(mesh.max())};
}

Certificate FromProto(const v1::Certificate& certificate) {
  return {.lattice = certificate.lattice(),
          .separability = certificate.separability(),
          .tunnel_free = certificate.tunnel_free(),
          .minimal = certificate.minimal(),
          .verified = certificate.verified(),
          .tunnels = certificate.tunnels(),
          .redundant = certificate.redundant(),
          .closed = certificate.closed(),
          .snap_error_max = certificate.snap_error_max(),
          .quantization_bits = certificate.quantization_bits(),
          .algorithm = certificate.algorithm(),
          .version = certificate.version(),
          .digest = certificate.digest(),
          .shard = certificate.has_shard() ? std::optional<Shard>(FromProto(certificate.shard())) : std::nullopt,
          .set = certificate.set(),
          .solid = certificate.has_solid()
                       ? std::optional(SolidFacts{certificate.solid().rule(), certificate.solid().unbalanced_lines()})
                       : std::nullopt,
          .band = certificate.has_band() ? std::optional(BandFacts{certificate.band().width()}) : std::nullopt,
          .fields = FieldsOf(certificate),
          .signed_distance = certificate.signed_distance(),
          .fraction_n = certificate.fraction_n(),
          .fraction_labels = {certificate.fraction_labels().begin(), certificate.fraction_labels().end()},
          .whole_minimal = certificate.whole_minimal(),
          .walk = certificate.has_walk() ? std::optional(FromProto(certificate.walk())) : std::nullopt,
          .interior_rule = certificate.interior_rule()};
}

v1::RawMesh ToProto(const RawMeshLayout& layout) {
  v1::RawMesh raw;
  raw.set_vertices(layout.vertices);
  raw.set_triangles(layout.triangles);
  raw.set_positions(layout.has_doubles ? v1::POSITION_TYPE_FLOAT64 : v1::POSITION_TYPE_FLOAT32);
  for (const Field field : layout.fields) raw.add_fields(ToProto(field));
  return raw;
}

}  // namespace

v1::VoxelizeSpec ToProto(const VoxelizeRequest& request, const MeshId& mesh, const std::optional<Vec3i>& resume_after) {
  v1::VoxelizeSpec spec;
  if (const Basis* basis = std::get_if<Basis>(&request.lattice)) {
    *spec.mutable_lattice()->mutable_basis()->mutable_a() = ToProto(basis->a);
    *spec.mutable_lattice()->mutable_basis()->mutable_b() = ToProto(basis->b);
    *spec.mutable_lattice()->mutable_basis()->mutable_c() = ToProto(basis->c);
  } else {
    spec.mutable_lattice()->set_named(ToProto(std::get<NamedLattice>(request.lattice)));
  }
  if (request.voxel_size) spec.set_voxel_size(*request.voxel_size);
  if (request.resolution) spec.set_resolution(*request.resolution);
  if (request.origin) *spec.mutable_origin() = ToProto(*request.origin);
  spec.set_separability(request.separability);
  if (request.minimal) spec.set_minimal(*request.minimal);
  if (request.region) {
    *spec.mutable_region()->mutable_min() = ToProto(request.region->min);
    *spec.mutable_region()->mutable_max() = ToProto(request.region->max);
  }
  if (request.bounds) {
    *spec.mutable_bounds()->mutable_min() = ToProto(request.bounds->min);
    *spec.mutable_bounds()->mutable_max() = ToProto(request.bounds->max);
  }
  spec.set_verify(request.verify);
  spec.set_mesh_bytes(mesh.bytes);
  spec.set_mesh_sha256(mesh.sha256.data(), mesh.sha256.size());
  if (request.shard) {
    spec.mutable_shard()->set_index(request.shard->index);
    spec.mutable_shard()->set_count(request.shard->count);
  }
  if (resume_after) *spec.mutable_resume_after() = ToProto(*resume_after);
  std::visit([&spec](const auto& set) { SetToProto(set, spec); }, request.set);
  spec.set_algorithm(ToProto(request.algorithm));
  spec.set_encoding(ToProto(request.encoding));
  if (request.placement) {
    spec.set_placement(*request.placement == Placement::kCells ? v1::PLACEMENT_CELLS : v1::PLACEMENT_POINTS);
  }
  for (const Field field : request.fields) spec.add_fields(ToProto(field));
  spec.set_signed_distance(request.signed_distance);
  spec.set_interior_rule(ToProto(request.interior_rule));
  spec.set_fraction_n(request.fraction_n);
  spec.mutable_fraction_labels()->Assign(request.fraction_labels.begin(), request.fraction_labels.end());
  if (request.raw_mesh) *spec.mutable_raw_mesh() = ToProto(*request.raw_mesh);
  return spec;
}

Accepted FromProto(const v1::Accepted& accepted) {
  Accepted out;
  out.request_id = accepted.request_id();
  const v1::Grid& grid = accepted.grid();
  out.grid.basis = {FromProto(grid.basis().a()), FromProto(grid.basis().b()), FromProto(grid.basis().c())};
  out.grid.origin = FromProto(grid.origin());
  out.grid.voxel_size = grid.voxel_size();
  if (accepted.has_index_box()) {
    out.index_box = IndexBox{FromProto(accepted.index_box().min()), FromProto(accepted.index_box().max())};
  }
  out.tiles_in_box = accepted.tiles_in_box();
  out.mesh = FromProto(accepted.mesh());
  for (const v1::Ijk& q : accepted.neighbors()) out.neighbors.push_back(FromProto(q));
  out.fraction_labels.assign(accepted.fraction_labels().begin(), accepted.fraction_labels().end());
  out.placement = grid.placement() == v1::PLACEMENT_CELLS ? Placement::kCells : Placement::kPoints;
  return out;
}

Summary FromProto(const v1::Summary& summary) {
  Summary out;
  out.voxels = summary.voxels();
  out.bricks = summary.bricks();
  out.tiles = summary.tiles();
  out.certificate = FromProto(summary.certificate());
  out.timings = {summary.timings().upload_ms(), summary.timings().decode_ms(), summary.timings().voxelize_ms(),
                 summary.timings().stream_ms()};
  out.mesh_bytes = summary.mesh_bytes();
  return out;
}

Limits FromProto(const v1::GetLimitsResponse& limits) {
  std::vector<Library> libraries;
  for (const v1::Library& library : limits.libraries()) libraries.push_back({library.name(), library.version()});
  return {.max_mesh_bytes = limits.max_mesh_bytes(),
          .max_triangles = limits.max_triangles(),
          .max_vertices = limits.max_vertices(),
          .max_extent = limits.max_extent(),
          .max_jobs = limits.max_jobs(),
          .max_message_bytes = limits.max_message_bytes(),
          .subvoxel_bits = limits.subvoxel_bits(),
          .version = limits.version(),
          .max_points = limits.max_points(),
          .max_crossings = limits.max_crossings(),
          .max_pixels = limits.max_pixels(),
          .max_queued_jobs = limits.max_queued_jobs(),
          .max_jobs_per_client = limits.max_jobs_per_client(),
          .memory_budget_bytes = limits.memory_budget_bytes(),
          .mesh_store_bytes = limits.mesh_store_bytes(),
          .max_visited_points = limits.max_visited_points(),
          .max_job_seconds = limits.max_job_seconds(),
          .commit = limits.commit(),
          .libraries = std::move(libraries)};
}

absl::Status FromGrpc(const grpc::Status& status) {
  // Both enumerations are the canonical codes, with the same numbers.
  absl::Status out(static_cast<absl::StatusCode>(status.error_code()), MessageOf(status));
  AttachWireDetails(status.error_details(), out);
  return out;
}

}  // namespace latvox::client
