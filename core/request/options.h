// A request as its caller describes it: each option by itself, whether or not they go together. core/request/rules.h
// judges.
#ifndef LATVOX_CORE_REQUEST_OPTIONS_H_
#define LATVOX_CORE_REQUEST_OPTIONS_H_

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/mesh/mesh.h"
#include "core/request/algorithm.h"
#include "core/request/band.h"
#include "core/request/fields.h"
#include "core/request/links.h"
#include "core/request/solid.h"
#include "core/request/walk.h"

namespace latvox {

// The index-th of `count` parts of a job with about the same cost: consecutive tiles in the canonical order.
struct Shard {
  uint32_t index = 0, count = 1;  // index < count <= kMaxShards
};

inline constexpr uint32_t kMaxShards = 1 << 20;

// The voxels of a surface that separate its sides.
struct SeparatingSurface {};

// All voxels whose closed Voronoi cell meets the surface.
struct SupercoverSurface {};

// A new set is one more struct here.
using SetOption = std::variant<SeparatingSurface, SupercoverSurface, Solid, Band, Enclosed, Connected, Links>;

struct VoxelizeOptions {
  int64_t separability = 0;                          // k: 0, 1 or 2
  std::optional<bool> minimal = std::nullopt;        // thin to k-minimality; default: wherever that is possible
  std::optional<IndexBox> region = std::nullopt;     // only these voxels, as in the whole
  std::optional<Bounds> bounds = std::nullopt;       // only voxels whose centers lie in this box: see WorldBox
  Algorithm algorithm = Algorithm::kExact;           // how to find the surface's voxels
  std::optional<Shard> shard = std::nullopt;         // only this part of the tiles
  std::optional<Vec3i> resume_after = std::nullopt;  // tile_ijk: leave out this tile and all before it
  SetOption set = SeparatingSurface{};               // which lattice points
  FieldList fields = {};                             // what each of them carries
  bool signed_distance = false;                      // distances are negative inside; needs Field::kDistance
  InteriorRule interior_rule = InteriorRule::kAuto;  // of signs, fields of cells, and sides of links; not for a solid
  uint32_t fraction_n = 0;                           // points along each axis; needs a field of cells
  std::vector<uint32_t> fraction_labels = {};        // of Field::kLabelFractions; none: all of the mesh, ascending
  bool verify = false;                               // count tunnels and redundant voxels of the finished set
};

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_OPTIONS_H_
