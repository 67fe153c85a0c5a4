// A request that keeps all rules: one set of lattice points, and the fields that each of them carries.
#ifndef LATVOX_CORE_REQUEST_REQUEST_H_
#define LATVOX_CORE_REQUEST_REQUEST_H_

#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/mesh/mesh.h"
#include "core/request/algorithm.h"
#include "core/request/band.h"
#include "core/request/fields.h"
#include "core/request/labels.h"
#include "core/request/links.h"
#include "core/request/options.h"
#include "core/request/solid.h"

namespace latvox {

// The voxels of a surface.
struct SurfaceSet {
  Algorithm algorithm = Algorithm::kExact;
  Cover cover = Cover::kSeparating;
  bool minimal = true;  // thinned to k-minimality: only kExact with kSeparating
};

// The lattice points inside a mesh, together with the surface's voxels unless solid.surface is kNone.
struct SolidSet {
  Solid solid;
  SurfaceSet surface;
};

// The lattice points near a mesh.
struct BandSet {
  Band band;
};

// The lattice points that a walk reaches, or does not reach: see core/request/walk.h.
struct WalkSet {
  std::optional<Vec3d> seed;  // the set is what a walk from here reaches; otherwise what none from outside does
  std::optional<Vec3d> leak_from;
  double close = 0;
  bool allow_outside = false, with_surface = false;
  SurfaceSet surface;                          // which the walk does not enter
  std::optional<Field> labels = std::nullopt;  // each number of this field has its own set
  std::vector<uint32_t> priority = {};         // of labels
};

// The ends of the links that a mesh crosses.
struct LinkSet {
  Links links;
};

// A new set is one more struct here.
using PointSet = std::variant<SurfaceSet, SolidSet, BandSet, WalkSet, LinkSet>;

// The parts of the whole that a request keeps. They are exactly as in the whole.
struct Part {
  std::optional<IndexBox> region = std::nullopt;     // keep only these voxels
  std::optional<Bounds> bounds = std::nullopt;       // keep only voxels whose centers lie in this box
  std::optional<Shard> shard = std::nullopt;         // keep only this part of the tiles
  std::optional<Vec3i> resume_after = std::nullopt;  // tile_ijk: drop this tile and all before it
};

struct VoxelRequest {
  int separability = 0;  // k: 0, 1 or 2
  PointSet set = SurfaceSet{};
  FieldList fields = {};
  bool signed_distance = false;                      // distances are negative inside
  InteriorRule interior_rule = InteriorRule::kAuto;  // for a solid, its own
  uint32_t fraction_n = 0;                           // a fraction counts this many points along each axis
  std::vector<uint32_t> fraction_labels = {};  // with Field::kLabelFractions; none: all labels of the mesh, ascending
  Part part = {};
  bool verify = false;  // count tunnels and redundant voxels of the finished set

  // Null if the request asks for another set.
  const Solid* solid() const;
  const Band* band() const;
  const WalkSet* walk() const;
  const Links* links() const;
  // Nullopt unless the set is labeled. The view lives as long as the request.
  std::optional<LabelRequest> labels() const;
  // The surface that is digitized, alone or for a solid or a walk; null for a band or links.
  const SurfaceSet* surface() const;

  // kExact for a band or links.
  Algorithm algorithm() const;
  bool is_supercover() const;
  // Whether the surface is thinned to k-minimality.
  bool is_minimal() const;
  // Whether voxels of the surface belong to the set.
  bool has_surface() const;
  // Whether set or fields depend on the inside of the mesh.
  bool needs_inside() const;
  // Whether the set fills space: a solid, or one that a walk decides.
  bool is_filled() const { return solid() != nullptr || walk() != nullptr; }
};

// "surface", "supercover", "solid", "supercover-solid", "interior", "band", "links", "enclosed", "enclosed-interior" or
// "region".
std::string_view NameOfSet(const VoxelRequest& request);

// Judges options by all rules that need no mesh: see core/request/rules.h. Errors: INVALID_ARGUMENT with the field, the
// value and the limit of the first rule that is broken, in the message and as payloads (core/base/status_payload.h).
absl::StatusOr<VoxelRequest> MakeRequest(const VoxelizeOptions& options);

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_REQUEST_H_
