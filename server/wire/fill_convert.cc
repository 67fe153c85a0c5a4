#include "server/wire/fill_convert.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

absl::StatusOr<InteriorRule> RuleFromProto(v1::InteriorRule rule) {
  switch (rule) {
    case v1::INTERIOR_RULE_UNSPECIFIED:
    case v1::INTERIOR_RULE_PARITY:
      return InteriorRule::kParity;
    case v1::INTERIOR_RULE_WINDING:
      return InteriorRule::kWinding;
    default:
      return BadSpec(absl::StrCat("fill.rule ", static_cast<int>(rule), " is not a rule"), "fill.rule",
                     absl::StrCat(static_cast<int>(rule)), "0 to 2");
  }
}

}  // namespace

absl::StatusOr<std::optional<Solid>> SolidFromProto(const v1::VoxelizeSpec& spec, Algorithm algorithm) {
  const v1::Fill& fill = spec.fill();
  if (fill.mode() == v1::FILL_MODE_UNSPECIFIED || fill.mode() == v1::FILL_MODE_SURFACE) return std::nullopt;
  if (fill.mode() != v1::FILL_MODE_SOLID) {
    return BadSpec(absl::StrCat("fill.mode ", static_cast<int>(fill.mode()), " is not a mode"), "fill.mode",
                   absl::StrCat(static_cast<int>(fill.mode())), "0 to 2");
  }
  const absl::StatusOr<InteriorRule> rule = RuleFromProto(fill.rule());
  if (!rule.ok()) return rule.status();
  if (spec.verify()) return BadSpec("verify: not together with fill.mode solid", "verify", "true");
  if (algorithm != Algorithm::kExact) {
    return BadSpec(
        absl::StrCat("fill.mode solid: not with the algorithm ", std::string{NameOf(algorithm)}, ", but with exact"),
        "fill.mode", "solid");
  }
  return Solid{.rule = *rule, .surface = !fill.without_surface(), .force_open = fill.force_open()};
}

v1::FillFacts FillFactsToProto(const Solid& solid, const JobFacts& facts) {
  v1::FillFacts fill;
  fill.set_rule(std::string{NameOf(solid.rule)});
  fill.set_with_surface(solid.surface);
  fill.set_unbalanced_lines(facts.unbalanced_lines);
  return fill;
}

}  // namespace latvox
