#include "core/request/request.h"

#include <variant>

#include "core/request/rules.h"

namespace latvox {
namespace {

SurfaceSet SurfaceOf(const VoxelizeOptions& options) {
  const bool can_be_minimal = options.algorithm == Algorithm::kExact && options.cover == Cover::kSeparating;
  return {options.algorithm, options.cover, can_be_minimal && options.minimal.value_or(true)};
}

PointSet SetOf(const VoxelizeOptions& options) {
  if (options.band) return BandSet{*options.band};
  if (options.solid) return SolidSet{*options.solid, SurfaceOf(options)};
  return SurfaceOf(options);
}

}  // namespace

const Solid* VoxelRequest::solid() const {
  const auto* solid = std::get_if<SolidSet>(&set);
  return solid != nullptr ? &solid->solid : nullptr;
}

const Band* VoxelRequest::band() const {
  const auto* band = std::get_if<BandSet>(&set);
  return band != nullptr ? &band->band : nullptr;
}

const SurfaceSet* VoxelRequest::surface() const {
  if (const auto* solid = std::get_if<SolidSet>(&set)) return &solid->surface;
  return std::get_if<SurfaceSet>(&set);
}

Algorithm VoxelRequest::algorithm() const { return surface() != nullptr ? surface()->algorithm : Algorithm::kExact; }

bool VoxelRequest::is_supercover() const { return surface() != nullptr && surface()->cover == Cover::kSupercover; }

bool VoxelRequest::is_minimal() const { return surface() != nullptr && surface()->minimal; }

absl::StatusOr<VoxelRequest> MakeRequest(const VoxelizeOptions& options) {
  if (absl::Status status = CheckRules(options); !status.ok()) return status;
  return VoxelRequest{static_cast<int>(options.separability),
                      SetOf(options),
                      options.fields,
                      {options.region, options.bounds, options.shard, options.resume_after},
                      options.verify};
}

}  // namespace latvox
