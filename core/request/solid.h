// A solid: the lattice points inside of a mesh.
#ifndef LATVOX_CORE_REQUEST_SOLID_H_
#define LATVOX_CORE_REQUEST_SOLID_H_

#include <cstdint>
#include <string_view>

namespace latvox {

// The rule for the inside, by the signed crossings of a path that comes from far away. A crossing counts +1 where the
// path goes against the triangle's normal, else -1.
enum class InteriorRule {
  kParity,   // an odd sum: every second shell is hollow; the triangles' orientation does not matter
  kWinding,  // a sum other than 0, the winding number: overlapping bodies are one
};

constexpr std::string_view NameOf(InteriorRule rule) { return rule == InteriorRule::kParity ? "parity" : "winding"; }

constexpr bool IsInside(InteriorRule rule, int32_t sum) {
  return rule == InteriorRule::kParity ? (sum & 1) != 0 : sum != 0;
}

struct Solid {
  InteriorRule rule = InteriorRule::kParity;
  bool surface = true;      // whether the surface's voxels belong to the solid
  bool force_open = false;  // fill a mesh that is not closed, where its lines along k are balanced
};

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_SOLID_H_
