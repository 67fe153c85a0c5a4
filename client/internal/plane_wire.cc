#include "client/internal/plane_wire.h"

#include <cmath>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "client/internal/broken_protocol.h"
#include "client/internal/digest.h"

namespace latvox::client {
namespace {

v1::Vector2 ToProto(const Vec2d& v) {
  v1::Vector2 out;
  out.set_x(v[0]);
  out.set_y(v[1]);
  return out;
}

Vec2d FromProto(const v1::Vector2& v) { return {v.x(), v.y()}; }

static_assert(v1::NamedPlaneLattice_MAX == kNamedPlaneLattices.size());
v1::NamedPlaneLattice ToProto(NamedPlaneLattice lattice) {
  return static_cast<v1::NamedPlaneLattice>(static_cast<int>(lattice) + 1);
}

v1::LineAlgorithm ToProto(LineAlgorithm algorithm) {
  switch (algorithm) {
    case LineAlgorithm::kExact:
      return v1::LINE_ALGORITHM_EXACT;
    case LineAlgorithm::kBruteForce:
      return v1::LINE_ALGORITHM_BRUTE_FORCE;
    case LineAlgorithm::kIncremental:
      return v1::LINE_ALGORITHM_INCREMENTAL;
    case LineAlgorithm::kIbanez:
      return v1::LINE_ALGORITHM_IBANEZ;
  }
  return v1::LINE_ALGORITHM_UNSPECIFIED;
}

bool IsFinite(const Vec2d& v) { return std::isfinite(v[0]) && std::isfinite(v[1]); }

bool IsUsable(const PlaneTransform& grid) {
  const auto& [a, b] = grid.basis;
  const double det = a[0] * b[1] - a[1] * b[0];
  return IsFinite(a) && IsFinite(b) && IsFinite(grid.origin) && std::isfinite(det) && det != 0 &&
         std::isfinite(grid.pixel_size) && grid.pixel_size > 0;
}

absl::Status ReadPixels(const v1::PixelizeResponse& response, std::vector<Vec2i>& pixels) {
  if (response.pixels_size() % 2 != 0) return Broken("pixels has ", response.pixels_size(), " numbers, an odd number");
  for (int n = 0; n < response.pixels_size(); n += 2) {
    const Vec2i ij = {response.pixels(n), response.pixels(n + 1)};
    if (!pixels.empty() && !(pixels.back() < ij)) return Broken("pixel ", ij[0], ",", ij[1], " is out of order");
    pixels.push_back(ij);
  }
  return absl::OkStatus();
}

// The digest of the voxels (i, j, 0).
std::string DigestOf(const std::vector<Vec2i>& pixels) {
  absl::flat_hash_map<Vec3i, std::array<uint64_t, 8>> masks;
  for (const auto& [i, j] : pixels) {
    masks[{i >> 3, j >> 3, 0}][static_cast<size_t>(i & 7)] |= uint64_t{1} << ((j & 7) << 3);
  }
  Digest digest;
  for (const auto& [brick_ijk, mask] : masks) digest.Add({brick_ijk, mask});
  return digest.ToHex();
}

}  // namespace

v1::PixelizeRequest ToProto(const PixelizeRequest& request) {
  v1::PixelizeRequest out;
  for (const Polyline& polyline : request.polylines) {
    v1::Polyline& to = *out.add_polylines();
    to.mutable_xy()->Reserve(static_cast<int>(2 * polyline.points.size()));
    for (const auto& [x, y] : polyline.points) {
      to.add_xy(x);
      to.add_xy(y);
    }
    to.set_closed(polyline.closed);
  }
  if (const PlaneBasis* basis = std::get_if<PlaneBasis>(&request.lattice)) {
    *out.mutable_lattice()->mutable_basis()->mutable_a() = ToProto(basis->a);
    *out.mutable_lattice()->mutable_basis()->mutable_b() = ToProto(basis->b);
  } else {
    out.mutable_lattice()->set_named(ToProto(std::get<NamedPlaneLattice>(request.lattice)));
  }
  if (request.pixel_size) out.set_pixel_size(*request.pixel_size);
  if (request.resolution) out.set_resolution(*request.resolution);
  if (request.origin) *out.mutable_origin() = ToProto(*request.origin);
  out.set_separability(request.separability);
  out.set_minimal(request.minimal);
  out.set_algorithm(ToProto(request.algorithm));
  return out;
}

absl::StatusOr<Pixelization> FromProto(const v1::PixelizeResponse& response) {
  Pixelization out;
  out.request_id = response.request_id();
  const v1::PlaneGrid& grid = response.grid();
  out.grid = {{FromProto(grid.basis().a()), FromProto(grid.basis().b())}, FromProto(grid.origin()), grid.pixel_size()};
  if (!IsUsable(out.grid)) return Broken("the grid is not finite or is singular");
  if (auto status = ReadPixels(response, out.pixels); !status.ok()) return status;
  out.crossed_edges = response.crossed_edges();
  out.tunnels = response.tunnels();
  out.redundant = response.redundant();
  out.snap_error_max = response.snap_error_max();
  out.lattice = response.lattice();
  out.algorithm = response.algorithm();
  out.version = response.version();
  out.digest = response.digest();
  if (const std::string digest = DigestOf(out.pixels); out.digest != digest) {
    return Broken("digest ", out.digest, ", the pixels' is ", digest);
  }
  out.pixelize_ms = response.pixelize_ms();
  return out;
}

}  // namespace latvox::client
