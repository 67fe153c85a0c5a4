// Sets of lattice points. VoxelizeSpec.set in proto/latvox/v1/voxelizer.proto describes them.
#ifndef LATVOX_LATVOX_SETS_H_
#define LATVOX_LATVOX_SETS_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "latvox/fields.h"
#include "latvox/lattice.h"

namespace latvox::client {

// The rule for the inside of a mesh: by the number of crossings on the way from outside, or by their sum. Each crossing
// counts + or - by the triangle's orientation.
enum class InteriorRule {
  kAuto,      // kWinding if triangles use every edge equally often both ways, otherwise kParity
  kParity,    // an odd number
  kWinding,   // a sum other than 0: overlapping bodies are one
  kPositive,  // a sum above 0: the same, and what is turned inside out is nowhere inside
};

// "auto", "parity", "winding" or "positive".
constexpr const char* NameOf(InteriorRule rule) {
  constexpr const char* kNames[] = {"auto", "parity", "winding", "positive"};
  return kNames[static_cast<size_t>(rule)];
}

// The voxels of the mesh itself that belong to a solid.
enum class SolidSurface {
  kSeparating,  // those of Surface
  kSupercover,  // those of Supercover
  kNone,        // none: every voxel's center is inside
};

// The ends of links that belong to a set.
enum class LinkSide {
  kBoth,     // all ends
  kInside,   // those inside of the mesh by VoxelizeRequest::interior_rule; it must be closed
  kOutside,  // those outside
};

// "both", "inside" or "outside".
constexpr const char* NameOf(LinkSide side) {
  constexpr const char* kNames[] = {"both", "inside", "outside"};
  return kNames[static_cast<size_t>(side)];
}

// The voxels of the mesh that separate its sides. This type and the next six are sets: see VoxelizeSpec.set in the
// protocol.
struct Surface {
  bool operator==(const Surface&) const = default;
};

// All voxels whose closed Voronoi cell meets the mesh (conservative): the same ones for every separability.
struct Supercover {
  bool operator==(const Supercover&) const = default;
};

// The points inside of the mesh. It must be closed: every edge belongs to an even number of triangles (kParity), or is
// used equally often both ways (kWinding, kPositive).
struct Solid {
  InteriorRule rule = InteriorRule::kAuto;           // the rule for the inside
  SolidSurface surface = SolidSurface::kSeparating;  // the voxels of the mesh itself that belong to it
  bool force_open = false;  // fill a mesh that is not closed, along the balanced lattice lines in k
  // A labeled solid: kPart or kMaterial, which must be among VoxelizeRequest.fields. Each number of it has its own
  // inside. Points inside have the number with the highest priority among those that contain them.
  std::optional<Field> labels = std::nullopt;
  std::vector<uint32_t> priority = {};  // from the highest down; then all other numbers, larger ones first
  bool operator==(const Solid&) const = default;
};

// The lattice points near the mesh: see Band in the protocol.
struct Band {
  double width = 0;        // finite; from 1/8192 of a voxel size to 256 voxels along any lattice axis
  bool in_voxels = false;  // width counts GridTransform.voxel_size; otherwise world units
  bool operator==(const Band&) const = default;
};

// The ends of all links between k-neighbors that the mesh crosses: see Links in the protocol.
struct Links {
  LinkSide side = LinkSide::kBoth;  // the ends that belong to it
  bool operator==(const Links&) const = default;
};

// The points that no walk from outside of the mesh reaches, by steps between k-neighbors that never enter a voxel of
// the surface. The mesh need not be closed: see Enclosed in the protocol. With labels, each label has the set of its
// own triangles alone, and the result is their union.
struct Enclosed {
  SolidSurface surface = SolidSurface::kSeparating;  // kNone leaves out the surface's voxels; not kSupercover
  double close = 0;                                  // closes holes, world units: see the protocol
  std::optional<Vec3d> leak_from = std::nullopt;     // world position whose way outside WalkFacts.leak reports
  std::optional<Field> labels = std::nullopt;        // as in Solid
  std::vector<uint32_t> priority = {};               // as in Solid
  bool operator==(const Enclosed&) const = default;
};

// The points that a walk as in Enclosed reaches from the lattice point nearest to a world position.
struct Connected {
  Vec3d seed{};                // world position where the walk starts
  double close = 0;            // as in Enclosed
  bool allow_outside = false;  // otherwise it is an error if the walk gets outside
  bool operator==(const Connected&) const = default;
};

// One set of lattice points.
using VoxelSet = std::variant<Surface, Supercover, Solid, Band, Links, Enclosed, Connected>;

// "surface", "supercover", "solid", "supercover-solid", "interior", "band", "links", "enclosed",
// "enclosed-interior" or "region": Certificate.set of its voxels.
constexpr const char* NameOf(const VoxelSet& set) {
  if (std::holds_alternative<Surface>(set)) return "surface";
  if (std::holds_alternative<Supercover>(set)) return "supercover";
  if (std::holds_alternative<Band>(set)) return "band";
  if (std::holds_alternative<Links>(set)) return "links";
  if (std::holds_alternative<Connected>(set)) return "region";
  if (const auto* enclosed = std::get_if<Enclosed>(&set)) {
    return enclosed->surface == SolidSurface::kNone ? "enclosed-interior" : "enclosed";
  }
  constexpr const char* kNames[] = {"solid", "supercover-solid", "interior"};
  return kNames[static_cast<size_t>(std::get<Solid>(set).surface)];
}

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_SETS_H_
