// A solid: the lattice points inside of a mesh.
#ifndef LATVOX_CORE_REQUEST_SOLID_H_
#define LATVOX_CORE_REQUEST_SOLID_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/request/fields.h"

namespace latvox {

// The rule for the inside, by the signed crossings of a path that comes from far away. A crossing counts +1 where the
// path goes against the triangle's normal, else -1.
enum class InteriorRule {
  kAuto,      // kWinding for an oriented mesh (core/solid/balance.h), otherwise kParity; a job decides
  kParity,    // an odd sum: every second shell is hollow; the triangles' orientation does not matter
  kWinding,   // a sum other than 0, the winding number: overlapping bodies are one
  kPositive,  // a sum above 0: the same, and what is turned inside out is nowhere inside
};

constexpr std::string_view NameOf(InteriorRule rule) {
  constexpr std::string_view kNames[] = {"auto", "parity", "winding", "positive"};
  return kNames[static_cast<size_t>(rule)];
}

// Returns the rule for a mesh, or for one whose labels are all oriented.
constexpr InteriorRule RuleFor(InteriorRule rule, bool oriented) {
  return rule != InteriorRule::kAuto ? rule : oriented ? InteriorRule::kWinding : InteriorRule::kParity;
}

// Precondition: the rule is not kAuto.
constexpr bool IsInside(InteriorRule rule, int32_t sum) {
  return rule == InteriorRule::kParity ? (sum & 1) != 0 : rule == InteriorRule::kPositive ? sum > 0 : sum != 0;
}

// Whether a line that ends with this sum is unbalanced. Precondition: the rule is not kAuto.
constexpr bool IsUnbalanced(InteriorRule rule, int32_t sum) {
  return rule == InteriorRule::kParity ? (sum & 1) != 0 : sum != 0;
}

// The voxels of the surface that belong to a solid.
enum class SolidSurface { kSeparating, kSupercover, kNone };

struct Solid {
  InteriorRule rule = InteriorRule::kAuto;
  SolidSurface surface = SolidSurface::kSeparating;
  bool force_open = false;  // fill a mesh that is not closed, where its lines along k are balanced
  // A labeled solid: each number of this field, which is Field::kPart or kMaterial, has its own inside.
  std::optional<Field> labels = std::nullopt;
  // Labels from the highest priority down. Labels that are not listed come after these, larger numbers first.
  std::vector<uint32_t> priority = {};
};

// The most labels that a solid can have.
inline constexpr size_t kMaxLabels = 1 << 16;

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_SOLID_H_
