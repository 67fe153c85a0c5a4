#include "server/wire/plane_convert.h"

#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/brick/voxel_set.h"
#include "core/snap/snap.h"
#include "core/voxelizer/digest.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

Vec2d FromProto(const v1::Vector2& v) { return {v.x(), v.y()}; }

void ToProto(const Vec2d& v, v1::Vector2& out) {
  out.set_x(v[0]);
  out.set_y(v[1]);
}

absl::Status NotOneOf(absl::string_view field, int value, absl::string_view kind, absl::string_view limit) {
  return BadSpec(absl::StrCat(field, " ", value, " is not ", kind), field, absl::StrCat(value), limit);
}

static_assert(v1::NamedPlaneLattice_MAX == kNamedPlaneLattices.size());
absl::StatusOr<PlaneLattice> NamedFromProto(v1::NamedPlaneLattice name) {
  const int number = static_cast<int>(name), count = static_cast<int>(kNamedPlaneLattices.size());
  if (number >= 1 && number <= count) return PlaneLattice::Named(static_cast<NamedPlaneLattice>(number - 1));
  return NotOneOf("lattice.named", number, "a lattice", absl::StrCat("1 to ", count));
}

absl::StatusOr<PlaneLattice> LatticeFromProto(const v1::PlaneLattice& lattice) {
  switch (lattice.kind_case()) {
    case v1::PlaneLattice::kNamed:
      return NamedFromProto(lattice.named());
    case v1::PlaneLattice::kBasis: {
      auto result = PlaneLattice::FromBasis({FromProto(lattice.basis().a()), FromProto(lattice.basis().b())});
      if (!result.ok()) return WithCause(result.status(), {"BAD_SPEC", "lattice.basis", "", ""});
      return result;
    }
    case v1::PlaneLattice::KIND_NOT_SET:
      break;
  }
  return BadSpec("lattice: neither named nor basis is set", "lattice", "");
}

absl::StatusOr<PlaneSampling> SamplingFromProto(const v1::PixelizeRequest& request) {
  switch (request.sampling_case()) {
    case v1::PixelizeRequest::kPixelSize: {
      const double size = request.pixel_size();
      if (std::isfinite(size) && size > 0) return PlaneSampling{size, std::nullopt};
      return BadSpec(absl::StrCat("pixel_size ", size, " is not a finite number above 0"), "pixel_size",
                     absl::StrCat(size), "0");
    }
    case v1::PixelizeRequest::kResolution: {
      const uint32_t resolution = request.resolution();
      if (resolution >= 2 && resolution <= kMaxPlaneResolution) return PlaneSampling{std::nullopt, resolution};
      const uint32_t limit = resolution < 2 ? 2 : kMaxPlaneResolution;
      return BadSpec(absl::StrCat("resolution ", resolution, resolution < 2 ? " is below " : " exceeds ", limit),
                     "resolution", absl::StrCat(resolution), absl::StrCat(limit));
    }
    case v1::PixelizeRequest::SAMPLING_NOT_SET:
      break;
  }
  if (request.lattice().has_basis()) return PlaneSampling{};
  return BadSpec("sampling: a named lattice needs pixel_size or resolution", "sampling", "");
}

absl::StatusOr<LineAlgorithm> AlgorithmFromProto(v1::LineAlgorithm algorithm) {
  switch (algorithm) {
    case v1::LINE_ALGORITHM_UNSPECIFIED:
    case v1::LINE_ALGORITHM_EXACT:
      return LineAlgorithm::kCrossing;
    case v1::LINE_ALGORITHM_BRUTE_FORCE:
      return LineAlgorithm::kBruteForce;
    case v1::LINE_ALGORITHM_INCREMENTAL:
      return LineAlgorithm::kIncremental;
    case v1::LINE_ALGORITHM_IBANEZ:
      return LineAlgorithm::kIbanez;
    default:
      return NotOneOf("algorithm", static_cast<int>(algorithm), "an algorithm", "0 to 4");
  }
}

const char* NameOf(LineAlgorithm algorithm) {
  switch (algorithm) {
    case LineAlgorithm::kCrossing:
      return "exact";
    case LineAlgorithm::kBruteForce:
      return "brute-force";
    case LineAlgorithm::kIncremental:
      return "incremental";
    case LineAlgorithm::kIbanez:
      return "ibanez";
  }
  return "";
}

absl::StatusOr<PixelizeOptions> OptionsFromProto(const v1::PixelizeRequest& request) {
  PixelizeOptions options;
  if (request.separability() > 1) {
    return BadSpec(absl::StrCat("separability ", request.separability(), " exceeds 1"), "separability",
                   absl::StrCat(request.separability()), "1");
  }
  options.separability = static_cast<int>(request.separability());
  if (request.has_minimal()) options.minimal = request.minimal();
  const absl::StatusOr<LineAlgorithm> algorithm = AlgorithmFromProto(request.algorithm());
  if (!algorithm.ok()) return algorithm.status();
  options.algorithm = *algorithm;
  return options;
}

absl::StatusOr<std::vector<Polyline>> PolylinesFromProto(const v1::PixelizeRequest& request, const Limits& limits) {
  if (const uint64_t points = CountPoints(request); points > limits.max_points()) {
    return LimitExceeded("points", points, limits.max_points());
  }
  std::vector<Polyline> polylines;
  for (const v1::Polyline& proto : request.polylines()) {
    if (proto.xy_size() % 2 != 0) {
      const std::string field = absl::StrCat("polylines[", polylines.size(), "].xy");
      return BadSpec(absl::StrCat(field, " has ", proto.xy_size(), " coordinates, which is odd"), field,
                     absl::StrCat(proto.xy_size()));
    }
    Polyline& polyline = polylines.emplace_back();
    polyline.closed = proto.closed();
    for (int n = 0; n < proto.xy_size(); ++n) {
      if (std::isfinite(proto.xy(n))) continue;
      const std::string field = absl::StrCat("polylines[", polylines.size() - 1, "].xy");
      return BadSpec(absl::StrCat(field, "[", n, "] ", proto.xy(n), " is not finite"), field,
                     absl::StrCat(proto.xy(n)));
    }
    for (int n = 0; n < proto.xy_size(); n += 2) polyline.points.push_back({proto.xy(n), proto.xy(n + 1)});
  }
  return polylines;
}

absl::Status CheckOrigin(const Vec2d& origin) {
  for (size_t m = 0; m < 2; ++m) {
    if (std::isfinite(origin[m])) continue;
    const std::string field = absl::StrCat("origin.", std::string(1, "xy"[m]));
    return BadSpec(absl::StrCat(field, " ", origin[m], " is not finite"), field, absl::StrCat(origin[m]));
  }
  return absl::OkStatus();
}

Digest DigestOf(const std::vector<Vec2i>& pixels) {
  VoxelSet voxels;
  for (const Vec2i& ij : pixels) voxels.Insert({ij[0], ij[1], 0});
  Digest digest;
  for (const Brick& brick : voxels.Bricks()) digest.Add(brick);
  return digest;
}

void GridToProto(const PlaneGrid& grid, v1::PlaneGrid& out) {
  ToProto(grid.lattice.basis()[0], *out.mutable_basis()->mutable_a());
  ToProto(grid.lattice.basis()[1], *out.mutable_basis()->mutable_b());
  ToProto(grid.origin, *out.mutable_origin());
  out.set_pixel_size(grid.lattice.pixel_size());
}

}  // namespace

uint64_t CountPoints(const v1::PixelizeRequest& request) {
  uint64_t points = 0;
  for (const v1::Polyline& polyline : request.polylines()) points += static_cast<uint64_t>(polyline.xy_size()) / 2;
  return points;
}

absl::StatusOr<PlaneJobSpec> PlaneJobSpecFromProto(const v1::PixelizeRequest& request, const Limits& limits) {
  absl::StatusOr<PlaneLattice> lattice = LatticeFromProto(request.lattice());
  if (!lattice.ok()) return lattice.status();
  const absl::StatusOr<PlaneSampling> sampling = SamplingFromProto(request);
  if (!sampling.ok()) return sampling.status();
  const absl::StatusOr<PixelizeOptions> options = OptionsFromProto(request);
  if (!options.ok()) return options.status();
  std::optional<Vec2d> origin;
  if (request.has_origin()) {
    origin = FromProto(request.origin());
    if (absl::Status status = CheckOrigin(*origin); !status.ok()) return status;
  }
  absl::StatusOr<std::vector<Polyline>> polylines = PolylinesFromProto(request, limits);
  if (!polylines.ok()) return polylines.status();
  PlaneJobSpec job{*std::move(polylines), *std::move(lattice), *sampling, origin, *options};
  if (request.sampling_case() != v1::PixelizeRequest::SAMPLING_NOT_SET) {
    job.fields.sampling = request.sampling_case() == v1::PixelizeRequest::kPixelSize ? "pixel_size" : "resolution";
  }
  return job;
}

v1::PixelizeResponse PixelsToProto(const PlaneJobSpec& spec, const PlaneGrid& grid, const PixelizeResult& result) {
  v1::PixelizeResponse response;
  GridToProto(grid, *response.mutable_grid());
  response.mutable_pixels()->Reserve(static_cast<int>(2 * result.pixels.size()));
  for (const Vec2i& ij : result.pixels) {
    response.add_pixels(ij[0]);
    response.add_pixels(ij[1]);
  }
  response.set_crossed_edges(result.crossed_links);
  response.set_tunnels(result.tunnels);
  response.set_redundant(result.redundant);
  response.set_snap_error_max(kSnapErrorMax);
  response.set_lattice(std::string{grid.lattice.name()});
  response.set_algorithm(NameOf(spec.options.algorithm));
  response.set_version(LATVOX_VERSION);
  response.set_digest(DigestOf(result.pixels).ToHex());
  return response;
}

}  // namespace latvox
