#include "core/request/grid_request.h"

#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/status_payload.h"
#include "core/request/breach.h"

namespace latvox {
namespace {

std::optional<Breach> FindBadSampling(const Sampling& sampling) {
  if (sampling.voxel_size) {
    if (auto breach = FindNotPositive("voxel_size", *sampling.voxel_size)) return breach;
  }
  if (!sampling.resolution) return std::nullopt;
  const uint32_t resolution = *sampling.resolution;
  if (sampling.voxel_size) return Breach{"resolution", "resolution: not together with voxel_size"};
  if (resolution >= 2 && resolution <= kMaxResolution) return std::nullopt;
  const uint32_t limit = resolution < 2 ? 2 : kMaxResolution;
  return Breach{"resolution",
                absl::StrCat("resolution ", resolution, resolution < 2 ? " is below " : " exceeds ", limit),
                absl::StrCat(resolution), absl::StrCat(limit)};
}

absl::Status CheckSamplingAndOrigin(const Sampling& sampling, const std::optional<Vec3d>& origin) {
  if (const auto breach = FindBadSampling(sampling)) return ToStatus(*breach);
  if (!origin) return absl::OkStatus();
  const auto breach = FindNotFinite("origin", *origin);
  return breach ? ToStatus(*breach) : absl::OkStatus();
}

absl::StatusOr<Lattice> LatticeOf(const std::variant<NamedLattice, Mat3d>& lattice) {
  if (const auto* name = std::get_if<NamedLattice>(&lattice)) return Lattice::Named(*name);
  auto of_basis = Lattice::FromBasis(std::get<Mat3d>(lattice));
  if (of_basis.ok()) return of_basis;
  return WithField(of_basis.status(), "lattice.basis", "");
}

}  // namespace

absl::StatusOr<GridRequest> MakeGridRequest(const GridOptions& options) {
  auto lattice = LatticeOf(options.lattice);
  if (!lattice.ok()) return lattice.status();
  const Sampling& sampling = options.sampling;
  if (std::holds_alternative<NamedLattice>(options.lattice) && !sampling.voxel_size && !sampling.resolution) {
    return ToStatus({"sampling", "sampling: a named lattice needs voxel_size or resolution"});
  }
  if (absl::Status status = CheckSamplingAndOrigin(sampling, options.origin); !status.ok()) return status;
  return GridRequest{*std::move(lattice), sampling, options.origin};
}

absl::StatusOr<Grid> ResolveGrid(const Lattice& lattice, const Sampling& sampling, const std::optional<Vec3d>& origin,
                                 const Bounds& bounds, Placement placement) {
  if (absl::Status status = CheckSamplingAndOrigin(sampling, origin); !status.ok()) return status;
  std::optional<double> voxel_size = sampling.voxel_size;
  if (sampling.resolution) {
    const uint32_t steps = placement == Placement::kCells ? *sampling.resolution : *sampling.resolution - 1;
    voxel_size = bounds.LongestSide() / steps;
    if (!(*voxel_size > 0)) {
      return absl::InvalidArgumentError("resolution: the mesh is a single point; give voxel_size");
    }
  }
  auto scaled = voxel_size ? lattice.Scaled(*voxel_size) : lattice;
  if (!scaled.ok()) {
    return WithValue(absl::InvalidArgumentError(
                         absl::StrFormat("voxel_size: at %g, %s", *voxel_size, std::string(scaled.status().message()))),
                     absl::StrFormat("%g", *voxel_size));
  }
  Vec3d low = bounds.min;
  for (double& x : low) x += placement == Placement::kCells ? scaled->voxel_size() / 2 : 0;
  return Grid{*std::move(scaled), origin.value_or(low)};
}

Placement PlacementFor(Placement asked, bool is_filled) {
  if (asked != Placement::kBySet) return asked;
  return is_filled ? Placement::kCells : Placement::kPoints;
}

}  // namespace latvox
