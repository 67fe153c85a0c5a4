#include "server/wire/convert.h"

#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/snap/snap.h"
#include "server/base/errors.h"
#include "server/wire/attribute_convert.h"
#include "server/wire/fill_convert.h"

namespace latvox {
namespace {

Vec3d FromProto(const v1::Vector3& v) { return {v.x(), v.y(), v.z()}; }
Vec3i FromProto(const v1::Ijk& ijk) { return {ijk.i(), ijk.j(), ijk.k()}; }

void ToProto(const Vec3d& v, v1::Vector3& out) {
  out.set_x(v[0]);
  out.set_y(v[1]);
  out.set_z(v[2]);
}

void ToProto(const Vec3i& ijk, v1::Ijk& out) {
  out.set_i(ijk[0]);
  out.set_j(ijk[1]);
  out.set_k(ijk[2]);
}

static_assert(v1::NamedLattice_MAX == kNamedLattices.size());
absl::StatusOr<Lattice> NamedFromProto(v1::NamedLattice name) {
  const int number = static_cast<int>(name), count = static_cast<int>(kNamedLattices.size());
  if (number >= 1 && number <= count) return Lattice::Named(static_cast<NamedLattice>(number - 1));
  return BadSpec(absl::StrCat("lattice.named ", number, " is not a lattice"), "lattice.named", absl::StrCat(number),
                 absl::StrCat("1 to ", count));
}

absl::StatusOr<Lattice> LatticeFromProto(const v1::Lattice& lattice) {
  switch (lattice.kind_case()) {
    case v1::Lattice::kNamed:
      return NamedFromProto(lattice.named());
    case v1::Lattice::kBasis: {
      const v1::Basis& basis = lattice.basis();
      auto result = Lattice::FromBasis({FromProto(basis.a()), FromProto(basis.b()), FromProto(basis.c())});
      if (!result.ok()) return WithCause(result.status(), {"BAD_SPEC", "lattice.basis", "", ""});
      return result;
    }
    case v1::Lattice::KIND_NOT_SET:
      break;
  }
  return BadSpec("lattice: neither named nor basis is set", "lattice", "");
}

absl::StatusOr<Density> DensityFromProto(const v1::VoxelizeSpec& spec) {
  switch (spec.density_case()) {
    case v1::VoxelizeSpec::kVoxelSize:
      if (std::isfinite(spec.voxel_size()) && spec.voxel_size() > 0) return Density{spec.voxel_size(), std::nullopt};
      return BadSpec(absl::StrCat("voxel_size ", spec.voxel_size(), " is not a finite number above 0"), "voxel_size",
                     absl::StrCat(spec.voxel_size()), "0");
    case v1::VoxelizeSpec::kResolution: {
      const uint32_t resolution = spec.resolution();
      if (resolution < 2) {
        return BadSpec(absl::StrCat("resolution ", resolution, " is below 2"), "resolution", absl::StrCat(resolution),
                       "2");
      }
      if (resolution > kMaxResolution) {
        return BadSpec(absl::StrCat("resolution ", resolution, " exceeds ", kMaxResolution), "resolution",
                       absl::StrCat(resolution), absl::StrCat(kMaxResolution));
      }
      return Density{std::nullopt, resolution};
    }
    case v1::VoxelizeSpec::DENSITY_NOT_SET:
      break;
  }
  if (spec.lattice().has_basis()) return Density{};
  return BadSpec("density: a named lattice needs voxel_size or resolution", "density", "");
}

absl::Status CheckFinite(const char* name, const Vec3d& v) {
  for (size_t m = 0; m < 3; ++m) {
    if (std::isfinite(v[m])) continue;
    const std::string field = absl::StrCat(name, ".", std::string(1, "xyz"[m]));
    return BadSpec(absl::StrCat(field, " ", v[m], " is not finite"), field, absl::StrCat(v[m]));
  }
  return absl::OkStatus();
}

absl::Status CheckRegion(const IndexBox& region) {
  for (size_t m = 0; m < 3; ++m) {
    if (region.min[m] < region.max[m]) continue;
    const std::string field = absl::StrCat("region.max.", std::string(1, "ijk"[m]));
    return BadSpec(absl::StrCat(field, " ", region.max[m], " is not above region.min's ", region.min[m]), field,
                   absl::StrCat(region.max[m]), absl::StrCat(region.min[m]));
  }
  return absl::OkStatus();
}

absl::StatusOr<Bounds> BoundsFromProto(const v1::WorldBox& box) {
  if (!box.has_min() || !box.has_max()) {
    const std::string field = box.has_min() ? "bounds.max" : "bounds.min";
    return BadSpec(absl::StrCat(field, " is not set"), field, "");
  }
  const Bounds bounds = {FromProto(box.min()), FromProto(box.max())};
  if (absl::Status status = CheckFinite("bounds.min", bounds.min); !status.ok()) return status;
  if (absl::Status status = CheckFinite("bounds.max", bounds.max); !status.ok()) return status;
  for (size_t m = 0; m < 3; ++m) {
    if (bounds.min[m] <= bounds.max[m]) continue;
    const std::string field = absl::StrCat("bounds.max.", std::string(1, "xyz"[m]));
    return BadSpec(absl::StrCat(field, " ", bounds.max[m], " is below bounds.min's ", bounds.min[m]), field,
                   absl::StrCat(bounds.max[m]), absl::StrCat(bounds.min[m]));
  }
  return bounds;
}

absl::Status CheckShard(const v1::Shard& shard) {
  if (shard.count() < 1 || shard.count() > kMaxShards) {
    return BadSpec(absl::StrCat("shard.count ", shard.count(), " is not within 1 to ", kMaxShards), "shard.count",
                   absl::StrCat(shard.count()), absl::StrCat(kMaxShards));
  }
  if (shard.index() < shard.count()) return absl::OkStatus();
  return BadSpec(absl::StrCat("shard.index ", shard.index(), " is not below shard.count ", shard.count()),
                 "shard.index", absl::StrCat(shard.index()), absl::StrCat(shard.count() - 1));
}

absl::StatusOr<Algorithm> AlgorithmFromProto(v1::Algorithm algorithm) {
  switch (algorithm) {
    case v1::ALGORITHM_UNSPECIFIED:
    case v1::ALGORITHM_EXACT:
      return Algorithm::kExact;
    case v1::ALGORITHM_BRUTE_FORCE:
      return Algorithm::kBruteForce;
    case v1::ALGORITHM_INCREMENTAL:
      return Algorithm::kIncremental;
    case v1::ALGORITHM_OPTIMIZED_INCREMENTAL:
      return Algorithm::kOptimizedIncremental;
    default:
      return BadSpec(absl::StrCat("algorithm ", static_cast<int>(algorithm), " is not an algorithm"), "algorithm",
                     absl::StrCat(static_cast<int>(algorithm)), "0 to 4");
  }
}

absl::StatusOr<Cover> CoverFromProto(const v1::VoxelizeSpec& spec, Algorithm algorithm) {
  switch (spec.cover()) {
    case v1::COVER_UNSPECIFIED:
    case v1::COVER_SEPARATING:
      return Cover::kSeparating;
    case v1::COVER_SUPERCOVER:
      if (algorithm != Algorithm::kExact) {
        return BadSpec(absl::StrCat("cover: supercover not together with algorithm ", std::string{NameOf(algorithm)}),
                       "cover", "supercover");
      }
      if (spec.has_minimal() && spec.minimal()) {
        return BadSpec("minimal: not together with cover supercover, which is not thinned", "minimal", "true");
      }
      return Cover::kSupercover;
    default:
      return BadSpec(absl::StrCat("cover ", static_cast<int>(spec.cover()), " is not a cover"), "cover",
                     absl::StrCat(static_cast<int>(spec.cover())), "0 to 2");
  }
}

absl::StatusOr<BrickEncoding> EncodingFromProto(v1::BrickEncoding encoding) {
  switch (encoding) {
    case v1::BRICK_ENCODING_UNSPECIFIED:
    case v1::BRICK_ENCODING_MASKS:
      return BrickEncoding::kMasks;
    case v1::BRICK_ENCODING_PACKED:
      return BrickEncoding::kPacked;
    case v1::BRICK_ENCODING_PACKED_ZSTD:
      return BrickEncoding::kPackedZstd;
    default:
      return BadSpec(absl::StrCat("encoding ", static_cast<int>(encoding), " is not an encoding"), "encoding",
                     absl::StrCat(static_cast<int>(encoding)), "0 to 3");
  }
}

absl::StatusOr<Band> BandFromProto(const v1::VoxelizeSpec& spec) {
  const v1::Band& band = spec.band();
  if (band.extent_case() == v1::Band::EXTENT_NOT_SET) {
    return BadSpec("band: neither width nor voxels is set", "band", "");
  }
  if (spec.verify()) return BadSpec("verify: not together with band", "verify", "true");
  if (spec.fill().mode() == v1::FILL_MODE_SOLID) return BadSpec("fill: not together with band", "fill", "solid");
  if (spec.cover() == v1::COVER_SUPERCOVER) return BadSpec("cover: not together with band", "cover", "supercover");
  const bool in_voxels = band.extent_case() == v1::Band::kVoxels;
  const double width = in_voxels ? band.voxels() : band.width();
  const char* field = in_voxels ? "band.voxels" : "band.width";
  if (!(std::isfinite(width) && width > 0)) {
    return BadSpec(absl::StrCat(field, " ", width, " is not a finite number above 0"), field, absl::StrCat(width), "0");
  }
  return Band{width, in_voxels, band.signed_()};
}

absl::StatusOr<VoxelizeOptions> OptionsFromProto(const v1::VoxelizeSpec& spec) {
  VoxelizeOptions options;
  if (spec.separability() > 2) {
    return BadSpec(absl::StrCat("separability ", spec.separability(), " exceeds 2"), "separability",
                   absl::StrCat(spec.separability()), "2");
  }
  options.separability = static_cast<int>(spec.separability());
  if (spec.has_minimal()) options.minimal = spec.minimal();
  const absl::StatusOr<Algorithm> algorithm = AlgorithmFromProto(spec.algorithm());
  if (!algorithm.ok()) return algorithm.status();
  options.algorithm = *algorithm;
  const absl::StatusOr<Cover> cover = CoverFromProto(spec, options.algorithm);
  if (!cover.ok()) return cover.status();
  options.cover = *cover;
  if (options.cover == Cover::kSupercover) options.minimal = false;
  if (spec.has_region()) {
    options.region = IndexBox{FromProto(spec.region().min()), FromProto(spec.region().max())};
    if (absl::Status status = CheckRegion(*options.region); !status.ok()) return status;
    if (spec.verify()) return BadSpec("verify: not together with region", "verify", "true");
  }
  if (spec.has_bounds()) {
    const absl::StatusOr<Bounds> bounds = BoundsFromProto(spec.bounds());
    if (!bounds.ok()) return bounds.status();
    if (spec.verify()) return BadSpec("verify: not together with bounds", "verify", "true");
    options.bounds = *bounds;
  }
  if (spec.has_shard()) {
    if (absl::Status status = CheckShard(spec.shard()); !status.ok()) return status;
    if (spec.verify()) return BadSpec("verify: not together with shard", "verify", "true");
    options.shard = Shard{spec.shard().index(), spec.shard().count()};
  }
  if (spec.has_resume_after()) options.resume_after = FromProto(spec.resume_after());
  const absl::StatusOr<std::optional<Solid>> solid = SolidFromProto(spec, options.algorithm);
  if (!solid.ok()) return solid.status();
  options.solid = *solid;
  if (spec.has_band()) {
    const absl::StatusOr<Band> band = BandFromProto(spec);
    if (!band.ok()) return band.status();
    options.band = *band;
  }
  return options;
}

// Whether nothing of the surface can lie outside of what all shards deliver. The box in `facts` is clipped to the
// region, so that one which touches the region's border may have been longer.
bool IsUncut(const VoxelizeOptions& options, const JobFacts& facts) {
  if (facts.cut_by_bounds) return false;
  if (!options.region) return true;
  if (!facts.index_box) return false;
  for (size_t m = 0; m < 3; ++m) {
    if (facts.index_box->min[m] <= options.region->min[m] || facts.index_box->max[m] >= options.region->max[m]) {
      return false;
    }
  }
  return true;
}

void GridToProto(const Grid& grid, v1::Grid& out) {
  const Mat3d& basis = grid.lattice.basis();
  ToProto(basis[0], *out.mutable_basis()->mutable_a());
  ToProto(basis[1], *out.mutable_basis()->mutable_b());
  ToProto(basis[2], *out.mutable_basis()->mutable_c());
  ToProto(grid.origin, *out.mutable_origin());
  out.set_voxel_size(grid.lattice.voxel_size());
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

}  // namespace

absl::StatusOr<JobSpec> JobSpecFromProto(const v1::VoxelizeSpec& spec, const Limits& limits) {
  if (spec.mesh_bytes() > limits.max_mesh_bytes) {
    return LimitExceeded("mesh_bytes", spec.mesh_bytes(), limits.max_mesh_bytes);
  }
  absl::StatusOr<Lattice> lattice = LatticeFromProto(spec.lattice());
  if (!lattice.ok()) return lattice.status();
  const absl::StatusOr<Density> density = DensityFromProto(spec);
  if (!density.ok()) return density.status();
  const absl::StatusOr<VoxelizeOptions> options = OptionsFromProto(spec);
  if (!options.ok()) return options.status();
  const absl::StatusOr<BrickEncoding> encoding = EncodingFromProto(spec.encoding());
  if (!encoding.ok()) return encoding.status();
  std::optional<Vec3d> origin;
  if (spec.has_origin()) {
    origin = FromProto(spec.origin());
    if (absl::Status status = CheckFinite("origin", *origin); !status.ok()) return status;
  }
  JobSpec job{*std::move(lattice), *density, origin, *options, spec.verify(), *encoding, spec.mesh_bytes()};
  if (!spec.mesh_sha256().empty()) {
    const absl::StatusOr<MeshDigest> digest = MeshDigestFrom(spec.mesh_sha256());
    if (!digest.ok()) return digest.status();
    job.mesh_digest = *digest;
  }
  const absl::StatusOr<MeshAttributes> attributes = AttributesFromProto(spec, job.options);
  if (!attributes.ok()) return attributes.status();
  job.attributes = *attributes;
  job.options.attributes = attributes->count;
  if (spec.density_case() != v1::VoxelizeSpec::DENSITY_NOT_SET) {
    job.fields.density = spec.density_case() == v1::VoxelizeSpec::kVoxelSize ? "voxel_size" : "resolution";
  }
  if (spec.has_band()) job.fields.band = spec.band().extent_case() == v1::Band::kVoxels ? "band.voxels" : "band.width";
  return job;
}

v1::Accepted AcceptedToProto(const std::string& request_id, const Grid& grid, const JobFacts& facts,
                             const MeshSource& source) {
  v1::Accepted accepted;
  accepted.set_request_id(request_id);
  GridToProto(grid, *accepted.mutable_grid());
  if (facts.index_box) {
    ToProto(facts.index_box->min, *accepted.mutable_index_box()->mutable_min());
    ToProto(facts.index_box->max, *accepted.mutable_index_box()->mutable_max());
  }
  accepted.set_tiles_in_box(facts.tiles_in_box);
  MeshFactsToProto(facts, source, *accepted.mutable_mesh());
  return accepted;
}

v1::Certificate CertificateToProto(const JobSpec& spec, const JobFacts& facts, const MeshSource& source,
                                   const JobTotals& totals, const std::optional<Verdict>& verdict) {
  v1::Certificate certificate;
  certificate.set_lattice(std::string{spec.lattice.name()});
  certificate.set_separability(static_cast<uint32_t>(spec.options.separability));
  const Verdict counted = verdict.value_or(Verdict{});
  if (const auto& band = spec.options.band) {
    certificate.mutable_band()->set_width(facts.band_width);
    certificate.mutable_band()->set_signed_(band->is_signed);
    certificate.mutable_band()->set_digest(totals.values.ToHex());
  } else if (spec.options.algorithm == Algorithm::kExact) {
    const bool surface = !spec.options.solid || spec.options.solid->surface;
    certificate.set_tunnel_free(surface);
    const bool one_of_several = spec.options.shard && spec.options.shard->count > 1;
    const bool minimal = surface && spec.options.minimal, uncut = IsUncut(spec.options, facts);
    certificate.set_whole_minimal(minimal && (uncut || !one_of_several));
    certificate.set_minimal(minimal && uncut && !one_of_several);
  } else {
    certificate.set_tunnel_free(verdict && counted.tunnels == 0);
    certificate.set_minimal(verdict && counted.tunnels == 0 && counted.redundant == 0);
    certificate.set_whole_minimal(certificate.minimal());
  }
  certificate.set_verified(verdict.has_value());
  certificate.set_tunnels(counted.tunnels);
  certificate.set_redundant(counted.redundant);
  certificate.set_closed(facts.closed);
  certificate.set_snap_error_max(facts.snap_error_max);
  certificate.set_quantization_bits(source.quantization_bits);
  certificate.set_algorithm(std::string{NameOf(spec.options.algorithm)});
  certificate.set_cover(std::string{NameOf(spec.options.cover)});
  certificate.set_version(LATVOX_VERSION);
  certificate.set_digest(totals.digest.ToHex());
  if (const auto& shard = spec.options.shard) {
    certificate.mutable_shard()->set_index(shard->index);
    certificate.mutable_shard()->set_count(shard->count);
  }
  if (const auto& solid = spec.options.solid) {
    *certificate.mutable_fill() = FillFactsToProto(*solid, facts);
  }
  if (spec.attributes.count != 0) *certificate.mutable_attributes() = AttributesToProto(spec.attributes, totals);
  return certificate;
}

v1::GetLimitsResponse LimitsToProto(const Limits& limits) {
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
  response.set_max_voxels(limits.max_voxels);
  return response;
}

}  // namespace latvox
