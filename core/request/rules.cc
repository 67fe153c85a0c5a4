#include "core/request/rules.h"

#include <algorithm>
#include <array>
#include <string>
#include <variant>

#include "absl/strings/str_cat.h"
#include "core/request/solid.h"

namespace latvox {
namespace {

using Found = std::optional<Breach>;

Found CheckSeparability(const VoxelizeOptions& options) {
  const int64_t k = options.separability;
  if (k >= 0 && k <= 2) return std::nullopt;
  return Breach{"separability", absl::StrCat("separability ", k, k < 0 ? " is below 0" : " exceeds 2"), absl::StrCat(k),
                k < 0 ? "0" : "2"};
}

Found CheckRegion(const VoxelizeOptions& options) {
  for (size_t m = 0; options.region && m < 3; ++m) {
    const int32_t min = options.region->min[m], max = options.region->max[m];
    if (min < max) continue;
    const std::string field = absl::StrCat("region.max.", std::string(1, "ijk"[m]));
    return Breach{field, absl::StrCat(field, " ", max, " is not above region.min's ", min), absl::StrCat(max),
                  absl::StrCat(min)};
  }
  return std::nullopt;
}

Found CheckBounds(const VoxelizeOptions& options) {
  if (!options.bounds) return std::nullopt;
  const auto& [low, high] = *options.bounds;
  if (Found breach = FindNotFinite("bounds.min", low)) return breach;
  if (Found breach = FindNotFinite("bounds.max", high)) return breach;
  for (size_t m = 0; m < 3; ++m) {
    if (low[m] <= high[m]) continue;
    const std::string field = absl::StrCat("bounds.max.", std::string(1, "xyz"[m]));
    return Breach{field, absl::StrCat(field, " ", high[m], " is below bounds.min's ", low[m]), absl::StrCat(high[m]),
                  absl::StrCat(low[m])};
  }
  return std::nullopt;
}

Found CheckShard(const VoxelizeOptions& options) {
  if (!options.shard) return std::nullopt;
  const auto& [index, count] = *options.shard;
  if (count < 1 || count > kMaxShards) {
    return Breach{"shard.count", absl::StrCat("shard.count ", count, " is not within 1 to ", kMaxShards),
                  absl::StrCat(count), absl::StrCat(kMaxShards)};
  }
  if (index < count) return std::nullopt;
  return Breach{"shard.index", absl::StrCat("shard.index ", index, " is not below shard.count ", count),
                absl::StrCat(index), absl::StrCat(count - 1)};
}

Found CheckBand(const VoxelizeOptions& options) {
  const Band* const band = std::get_if<Band>(&options.set);
  if (band == nullptr) return std::nullopt;
  return FindNotPositive(band->in_voxels ? "band.voxels" : "band.width", band->width);
}

Found CheckEnclosed(const VoxelizeOptions& options) {
  const auto* const enclosed = std::get_if<Enclosed>(&options.set);
  if (enclosed == nullptr) return std::nullopt;
  if (enclosed->surface == SolidSurface::kSupercover) {
    return Breach{"enclosed.surface", "enclosed.surface supercover: is not separating or none", "supercover"};
  }
  if (Found breach = FindNegative("enclosed.close", enclosed->close)) return breach;
  return enclosed->leak_from ? FindNotFinite("enclosed.leak_from", *enclosed->leak_from) : std::nullopt;
}

Found CheckConnected(const VoxelizeOptions& options) {
  const auto* const connected = std::get_if<Connected>(&options.set);
  if (connected == nullptr) return std::nullopt;
  if (Found breach = FindNotFinite("connected.seed", connected->seed)) return breach;
  return FindNegative("connected.close", connected->close);
}

Found CheckSignedDistance(const VoxelizeOptions& options) {
  if (!options.signed_distance || options.fields.Contains(Field::kDistance)) return std::nullopt;
  return Breach{"signed_distance", "signed_distance true: needs distance among fields", "true"};
}

Found CheckInteriorRule(const VoxelizeOptions& options) {
  if (options.interior_rule == InteriorRule::kAuto) return std::nullopt;
  const std::string rule{NameOf(options.interior_rule)}, shown = absl::StrCat("interior_rule ", rule);
  if (std::holds_alternative<Solid>(options.set)) {
    return Breach{"interior_rule", absl::StrCat(shown, ": not together with solid, which has a rule of its own"), rule,
                  "", "solid"};
  }
  const Links* const links = std::get_if<Links>(&options.set);
  const bool has_side = links != nullptr && links->side != LinkSide::kBoth;
  if (has_side || options.signed_distance || !options.fields.OfCells().empty()) return std::nullopt;
  return Breach{"interior_rule",
                absl::StrCat(shown, ": needs signed_distance, fraction among fields, or one side of links"), rule};
}

Found CheckFraction(const VoxelizeOptions& options) {
  const uint32_t n = options.fraction_n;
  if (options.fields.OfCells().empty()) {
    if (n == 0) return std::nullopt;
    return Breach{"fraction_n", absl::StrCat("fraction_n ", n, ": needs fraction or label_fractions among fields"),
                  absl::StrCat(n)};
  }
  if (n >= kLeastFraction && n <= kMostFraction) return std::nullopt;
  const std::string limit = absl::StrCat(n < kLeastFraction ? kLeastFraction : kMostFraction);
  return Breach{"fraction_n", absl::StrCat("fraction_n ", n, n < kLeastFraction ? " is below " : " exceeds ", limit),
                absl::StrCat(n), limit};
}

// The sets with labels have the same rules for them.
template <class Set>
constexpr const char* kNameOfSet = nullptr;
template <>
constexpr const char* kNameOfSet<Solid> = "solid";
template <>
constexpr const char* kNameOfSet<Enclosed> = "enclosed";

template <class Set>
Found CheckLabels(const VoxelizeOptions& options) {
  const auto* const set = std::get_if<Set>(&options.set);
  if (set == nullptr || !set->labels) return std::nullopt;
  const std::string name = NameOf(*set->labels), field = absl::StrCat(kNameOfSet<Set>, ".labels");
  if (*set->labels != Field::kPart && *set->labels != Field::kMaterial) {
    return Breach{field, absl::StrCat(field, " ", name, " is neither part nor material"), name};
  }
  if (options.fields.Contains(*set->labels)) return std::nullopt;
  return Breach{field, absl::StrCat(field, " ", name, ": needs ", name, " among fields"), name};
}

// A list of labels in `field`: at most `most`, each once.
Found FindBadLabels(const std::string& field, const std::vector<uint32_t>& labels, size_t most) {
  constexpr uint32_t kLargest = FactsOf(Field::kPart).largest;
  static_assert(kLargest == FactsOf(Field::kMaterial).largest);
  if (labels.size() > most) {
    return Breach{field, absl::StrCat(field, ": ", labels.size(), " labels exceed ", most), absl::StrCat(labels.size()),
                  absl::StrCat(most)};
  }
  for (const uint32_t label : labels) {
    if (label <= kLargest) continue;
    return Breach{field, absl::StrCat(field, " ", label, " exceeds ", kLargest), absl::StrCat(label),
                  absl::StrCat(kLargest)};
  }
  std::vector<uint32_t> sorted = labels;
  std::ranges::sort(sorted);
  const auto twice = std::ranges::adjacent_find(sorted);
  if (twice == sorted.end()) return std::nullopt;
  return Breach{field, absl::StrCat(field, " ", *twice, " occurs twice"), absl::StrCat(*twice)};
}

template <class Set>
Found CheckPriority(const VoxelizeOptions& options) {
  const auto* const set = std::get_if<Set>(&options.set);
  if (set == nullptr || set->priority.empty()) return std::nullopt;
  const std::string field = absl::StrCat(kNameOfSet<Set>, ".priority");
  if (!set->labels) return Breach{field, absl::StrCat(field, ": needs ", kNameOfSet<Set>, ".labels")};
  return FindBadLabels(field, set->priority, kMaxLabels);
}

Found CheckFractionLabels(const VoxelizeOptions& options) {
  if (!options.fields.Contains(Field::kLabelFractions)) {
    if (options.fraction_labels.empty()) return std::nullopt;
    return Breach{"fraction_labels", "fraction_labels: needs label_fractions among fields"};
  }
  if (std::holds_alternative<Enclosed>(options.set)) {
    return Breach{"fields", "fields label_fractions: not together with enclosed, whose triangles need not be closed",
                  NameOf(Field::kLabelFractions), "", "enclosed"};
  }
  const Solid* const solid = std::get_if<Solid>(&options.set);
  if (solid == nullptr || !solid->labels) {
    return Breach{"fields", "fields label_fractions: needs a solid with solid.labels", NameOf(Field::kLabelFractions)};
  }
  return FindBadLabels("fraction_labels", options.fraction_labels, kMostFractionLabels);
}

constexpr std::array kValueRules{
    ValueRule{"separability", CheckSeparability},
    ValueRule{"region", CheckRegion},
    ValueRule{"bounds", CheckBounds},
    ValueRule{"shard", CheckShard},
    ValueRule{"band", CheckBand},
    ValueRule{"enclosed", CheckEnclosed},
    ValueRule{"connected", CheckConnected},
    ValueRule{"signed_distance", CheckSignedDistance},
    ValueRule{"interior_rule", CheckInteriorRule},
    ValueRule{"fraction_n", CheckFraction},
    ValueRule{"solid.labels", CheckLabels<Solid>},
    ValueRule{"solid.priority", CheckPriority<Solid>},
    ValueRule{"enclosed.labels", CheckLabels<Enclosed>},
    ValueRule{"enclosed.priority", CheckPriority<Enclosed>},
    ValueRule{"fraction_labels", CheckFractionLabels},
};

using O = VoxelizeOptions;

std::string None(const O&) { return ""; }

template <class Set>
bool Is(const O& options) {
  return std::holds_alternative<Set>(options.set);
}

std::optional<SolidSurface> SurfaceOfSolid(const O& options) {
  const Solid* const solid = std::get_if<Solid>(&options.set);
  return solid == nullptr ? std::nullopt : std::optional(solid->surface);
}

// An option with its default value counts as not given. Fields of links depend on separability, whatever the set.
constexpr std::array kOptions{
    Option{"separability", "separability", "`separability` above 0 without fields of links",
           [](const O& o) { return o.separability != 0 && o.fields.OfLinks().empty(); },
           [](const O& o) { return absl::StrCat(o.separability); }},
    Option{"minimal", "minimal", "`minimal` true", [](const O& o) { return o.minimal.value_or(false); }, None},
    Option{"algorithm", "algorithm", "`algorithm` other than exact",
           [](const O& o) { return o.algorithm != Algorithm::kExact; },
           [](const O& o) { return std::string{NameOf(o.algorithm)}; }},
    Option{"supercover", "supercover", "`supercover`", [](const O& o) { return Is<SupercoverSurface>(o); }, None},
    Option{"solid", "solid", "`solid`", [](const O& o) { return Is<Solid>(o); }, None},
    Option{"supercover of a solid", "solid.surface", "`solid.surface` supercover",
           [](const O& o) { return SurfaceOfSolid(o) == SolidSurface::kSupercover; },
           [](const O&) -> std::string { return "supercover"; }},
    Option{"interior alone", "solid.surface", "`solid.surface` none",
           [](const O& o) { return SurfaceOfSolid(o) == SolidSurface::kNone; },
           [](const O&) -> std::string { return "none"; }},
    Option{"band", "band", "`band`", [](const O& o) { return Is<Band>(o); }, None},
    Option{"enclosed", "enclosed", "`enclosed`", [](const O& o) { return Is<Enclosed>(o); }, None},
    Option{"connected", "connected", "`connected`", [](const O& o) { return Is<Connected>(o); }, None},
    Option{"links", "links", "`links`", [](const O& o) { return Is<Links>(o); }, None},
    Option{"fraction", "fields", "fraction or label_fractions among `fields`",
           [](const O& o) { return !o.fields.OfCells().empty(); },
           [](const O& o) -> std::string { return NameOf(*o.fields.OfCells().begin()); }},
    Option{"open solid", "solid.force_open", "`solid.force_open`",
           [](const O& o) { return Is<Solid>(o) && std::get<Solid>(o.set).force_open; },
           [](const O&) -> std::string { return "true"; }},
    Option{"fields", "fields", "`fields`", [](const O& o) { return !o.fields.empty(); }, None},
    Option{"region", "region", "`region`", [](const O& o) { return o.region.has_value(); }, None},
    Option{"bounds", "bounds", "`bounds`", [](const O& o) { return o.bounds.has_value(); }, None},
    Option{"shard", "shard", "`shard`", [](const O& o) { return o.shard.has_value(); }, None},
    Option{"verify", "verify", "`verify`", [](const O& o) { return o.verify; }, None},
};

constexpr std::array kExclusions{
    Exclusion{"minimal", "algorithm", ", which is not thinned"},
    Exclusion{"minimal", "supercover", ", which is not thinned"},
    Exclusion{"minimal", "supercover of a solid", ", which is not thinned"},
    Exclusion{"minimal", "band", ", which is not thinned"},
    Exclusion{"minimal", "interior alone", ", which is not thinned"},
    Exclusion{"minimal", "links", ", which is not thinned"},
    Exclusion{"supercover", "algorithm"},
    Exclusion{"solid", "algorithm"},
    Exclusion{"separability", "interior alone", ", which has no voxels of the surface"},
    Exclusion{"band", "algorithm"},
    Exclusion{"separability", "band"},
    Exclusion{"links", "algorithm"},
    Exclusion{"fields", "algorithm"},
    Exclusion{"verify", "region"},
    Exclusion{"verify", "bounds"},
    Exclusion{"verify", "shard"},
    Exclusion{"verify", "solid"},
    Exclusion{"verify", "band"},
    Exclusion{"enclosed", "algorithm"},
    Exclusion{"connected", "algorithm"},
    Exclusion{"verify", "enclosed"},
    Exclusion{"verify", "connected"},
    Exclusion{"verify", "links"},
    Exclusion{"fraction", "open solid", ", which fills a mesh that is not closed"},
};

constexpr const Option* OptionNamed(std::string_view name) {
  const auto* const found = std::ranges::find(kOptions, name, &Option::name);
  return found == kOptions.end() ? nullptr : found;
}

static_assert(std::ranges::all_of(kExclusions,
                                  [](const Exclusion& rule) {
                                    return OptionNamed(rule.option) != nullptr && OptionNamed(rule.other) != nullptr;
                                  }),
              "exclusions name options of the table");

std::string Shown(const Option& option, const std::string& value) {
  return value.empty() ? std::string{option.field} : absl::StrCat(std::string{option.field}, " ", value);
}

Found FindExclusion(const Exclusion& rule, const VoxelizeOptions& options) {
  const Option &option = *OptionNamed(rule.option), &other = *OptionNamed(rule.other);
  if (!option.is_given(options) || !other.is_given(options)) return std::nullopt;
  const std::string value = option.value(options);
  return Breach{std::string{option.field},
                absl::StrCat(Shown(option, value), ": not together with ", Shown(other, other.value(options)),
                             std::string{rule.why}),
                value, "", std::string{other.field}};
}

}  // namespace

std::span<const ValueRule> ValueRules() { return kValueRules; }
std::span<const Option> Options() { return kOptions; }
std::span<const Exclusion> Exclusions() { return kExclusions; }

absl::Status CheckRules(const VoxelizeOptions& options) {
  for (const ValueRule& rule : kValueRules) {
    if (const Found breach = rule.find(options)) return ToStatus(*breach);
  }
  for (const Exclusion& rule : kExclusions) {
    if (const Found breach = FindExclusion(rule, options)) return ToStatus(*breach);
  }
  return absl::OkStatus();
}

}  // namespace latvox
