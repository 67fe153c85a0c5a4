#include "core/request/request.h"

#include <variant>

#include "core/request/rules.h"

namespace latvox {
namespace {

template <class T>
bool Is(const SetOption& set) {
  return std::holds_alternative<T>(set);
}

Cover CoverOf(const SetOption& set) {
  const Solid* const solid = std::get_if<Solid>(&set);
  const bool is_supercover =
      solid != nullptr ? solid->surface == SolidSurface::kSupercover : Is<SupercoverSurface>(set);
  return is_supercover ? Cover::kSupercover : Cover::kSeparating;
}

SurfaceSet SurfaceOf(const VoxelizeOptions& options) {
  const Cover cover = CoverOf(options.set);
  const bool can_be_minimal = options.algorithm == Algorithm::kExact && cover == Cover::kSeparating;
  return {options.algorithm, cover, can_be_minimal && options.minimal.value_or(true)};
}

PointSet SetOf(const VoxelizeOptions& options) {
  if (const Band* band = std::get_if<Band>(&options.set)) return BandSet{*band};
  if (const Links* links = std::get_if<Links>(&options.set)) return LinkSet{*links};
  const SurfaceSet surface = SurfaceOf(options);
  if (const auto* enclosed = std::get_if<Enclosed>(&options.set)) {
    return WalkSet{
        std::nullopt, enclosed->leak_from, enclosed->close,   false, enclosed->surface != SolidSurface::kNone,
        surface,      enclosed->labels,    enclosed->priority};
  }
  if (const auto* connected = std::get_if<Connected>(&options.set)) {
    return WalkSet{connected->seed, std::nullopt, connected->close, connected->allow_outside, false, surface};
  }
  if (const Solid* solid = std::get_if<Solid>(&options.set)) return SolidSet{*solid, surface};
  return surface;
}

InteriorRule RuleOf(const VoxelizeOptions& options) {
  const Solid* const solid = std::get_if<Solid>(&options.set);
  return solid != nullptr ? solid->rule : options.interior_rule;
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

const WalkSet* VoxelRequest::walk() const { return std::get_if<WalkSet>(&set); }

const Links* VoxelRequest::links() const {
  const auto* links = std::get_if<LinkSet>(&set);
  return links != nullptr ? &links->links : nullptr;
}

std::optional<LabelRequest> VoxelRequest::labels() const {
  if (solid() != nullptr && solid()->labels) {
    return LabelRequest{*solid()->labels, solid()->priority, "solid.labels", kMaxLabels};
  }
  if (walk() != nullptr && walk()->labels) {
    return LabelRequest{*walk()->labels, walk()->priority, "enclosed.labels", kMaxWalkLabels};
  }
  return std::nullopt;
}

const SurfaceSet* VoxelRequest::surface() const {
  if (walk() != nullptr) return &walk()->surface;
  if (const auto* solid = std::get_if<SolidSet>(&set)) return &solid->surface;
  return std::get_if<SurfaceSet>(&set);
}

Algorithm VoxelRequest::algorithm() const { return surface() != nullptr ? surface()->algorithm : Algorithm::kExact; }

bool VoxelRequest::is_supercover() const { return surface() != nullptr && surface()->cover == Cover::kSupercover; }

bool VoxelRequest::is_minimal() const { return surface() != nullptr && surface()->minimal; }

bool VoxelRequest::has_surface() const {
  if (walk() != nullptr) return walk()->with_surface;
  return surface() != nullptr && (solid() == nullptr || solid()->surface != SolidSurface::kNone);
}

bool VoxelRequest::needs_inside() const {
  return solid() != nullptr || signed_distance || !fields.OfCells().empty() ||
         (links() != nullptr && links()->side != LinkSide::kBoth);
}

std::string_view NameOfSet(const VoxelRequest& request) {
  if (request.band() != nullptr) return "band";
  if (const WalkSet* walk = request.walk()) {
    return walk->seed ? "region" : walk->with_surface ? "enclosed" : "enclosed-interior";
  }
  if (request.links() != nullptr) return "links";
  if (request.solid() == nullptr) return request.is_supercover() ? "supercover" : "surface";
  return !request.has_surface() ? "interior" : request.is_supercover() ? "supercover-solid" : "solid";
}

absl::StatusOr<VoxelRequest> MakeRequest(const VoxelizeOptions& options) {
  if (absl::Status status = CheckRules(options); !status.ok()) return status;
  return VoxelRequest{static_cast<int>(options.separability),
                      SetOf(options),
                      options.fields,
                      options.signed_distance,
                      RuleOf(options),
                      options.fraction_n,
                      options.fraction_labels,
                      {options.region, options.bounds, options.shard, options.resume_after},
                      options.verify};
}

}  // namespace latvox
