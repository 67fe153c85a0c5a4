// The grid that a request asks for, before the mesh is known.
#ifndef LATVOX_CORE_REQUEST_GRID_REQUEST_H_
#define LATVOX_CORE_REQUEST_GRID_REQUEST_H_

#include <cstdint>
#include <optional>
#include <variant>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/vec.h"
#include "core/lattice/grid.h"
#include "core/lattice/lattice.h"
#include "core/mesh/mesh.h"

namespace latvox {

// The sampling density: none (the lattice as it is), a voxel size, or a number of voxels along the longest side of the
// mesh.
struct Sampling {
  std::optional<double> voxel_size = std::nullopt;    // world units, finite, > 0
  std::optional<uint32_t> resolution = std::nullopt;  // 2 .. kMaxResolution, along the longest side: see Placement
};

// The place of lattice points in the mesh's box, as far as sampling and origin leave it open.
//   kPoints   voxel_size = longest side / (resolution - 1); lattice point 0 is the box's low corner
//   kCells    voxel_size = longest side / resolution; lattice point 0 is half a voxel_size above the low corner, along
//             each axis of the world
//   kBySet    kCells for a set that fills space, otherwise kPoints
enum class Placement { kBySet, kPoints, kCells };

inline constexpr uint32_t kMaxResolution = 65536;

// A grid as the caller describes it.
struct GridOptions {
  std::variant<NamedLattice, Mat3d> lattice;  // by name, or by its basis vectors as columns, world units
  Sampling sampling;                          // a named lattice needs one
  std::optional<Vec3d> origin;                // world position of lattice point 0; default: by the placement
};

// A grid that lacks only a mesh.
struct GridRequest {
  Lattice lattice;
  Sampling sampling = {};
  std::optional<Vec3d> origin = std::nullopt;
};

// Errors: INVALID_ARGUMENT as MakeRequest, for sampling, origin and lattice.basis.
absl::StatusOr<GridRequest> MakeGridRequest(const GridOptions& options);

// Returns the grid for a mesh with these bounds. Precondition: the placement is not kBySet. Errors: INVALID_ARGUMENT
// naming field, value and limit, if the sampling gives no lattice with such a mesh, and the errors of MakeGridRequest
// about sampling and origin.
absl::StatusOr<Grid> ResolveGrid(const Lattice& lattice, const Sampling& sampling, const std::optional<Vec3d>& origin,
                                 const Bounds& bounds, Placement placement = Placement::kPoints);

// Returns the placement of a request: kBySet becomes one of the others.
Placement PlacementFor(Placement asked, bool is_filled);

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_GRID_REQUEST_H_
