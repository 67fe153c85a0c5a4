// The one rounding: world coordinates -> fixed-point lattice coordinates.
//
// Frames:
//   _lat   fixed-point lattice coordinates relative to `base_ijk`, in units of 1/kLatticeUnit of a voxel (int32)
//   ijk    lattice coordinates; ijk - base_ijk is called local
// Everything after this room is integer arithmetic, whose widths are derived here.
#ifndef LATVOX_CORE_SNAP_SNAP_H_
#define LATVOX_CORE_SNAP_SNAP_H_

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/shared_array.h"
#include "core/base/stop_signal.h"
#include "core/base/uninitialized.h"
#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/lattice/lattice.h"
#include "core/mesh/mesh.h"

namespace latvox {

inline constexpr int kSubvoxelBits = 8;  // F: fractional bits of lattice coordinates
inline constexpr int32_t kLatticeUnit = 1 << kSubvoxelBits;

// E: a mesh may extend over 2^E voxels along each lattice axis. 65,536 voxels along the longest world axis need up to
// 1.9 times that in index space (FCC).
inline constexpr int kExtentBits = 17;
inline constexpr int32_t kMaxExtent = 1 << kExtentBits;

// Lattice coordinates ijk of a mesh stay within +-2^kPositionBits, so that voxels and halos fit int32.
inline constexpr int kPositionBits = 29;

// Bit widths of absolute values (without sign), for the integers of core/digitize. Differences of two vertices, per
// axis:
inline constexpr int kEdgeBits = kExtentBits + kSubvoxelBits;
// The normal (cross product of two edges), per axis:
inline constexpr int kNormalBits = 2 * kEdgeBits + 1;
// Projected by a frame's row, |row| <= kMaxFrameRow = 2^2; positions carry one bit more for tile alignment and halo:
inline constexpr int kProjectedBits = kEdgeBits + 1 + 2;
// Edge functions: the sum of two products of projected differences.
inline constexpr int kEdgeFunctionBits = 2 * kProjectedBits + 1;
// Normal times direction, |q| <= kMaxDirection = 2^3, in sub-voxel units: the denominator of depths.
inline constexpr int kDepthDenominatorBits = kNormalBits + 3 + kSubvoxelBits;
static_assert(kMaxFrameRow <= 4 && kMaxDirection <= 8);
static_assert(kEdgeFunctionBits + 1 <= 63, "edge functions must fit int64");
static_assert(kDepthDenominatorBits <= 62, "twice a remainder of depths must fit int64");

// A mesh in fixed-point lattice coordinates.
struct SnappedMesh {
  Vec3i base_ijk;                                               // a multiple of kTileSide on every axis
  SharedArray<PaddedVector<Vec3i>> vertices_lat;                // 0 <= v < (kMaxExtent + kTileSide) * kLatticeUnit
  SharedArray<std::vector<std::array<uint32_t, 3>>> triangles;  // indices into vertices_lat
  IndexBox box;  // local voxels: no half link that starts outside meets the mesh

  // The corners of a triangle.
  std::array<Vec3i, 3> TriangleAt(size_t t) const {
    const auto& [a, b, c] = triangles[t];
    return {vertices_lat[a], vertices_lat[b], vertices_lat[c]};
  }
};

// Largest move of a vertex by snapping, in each lattice coordinate, in voxels: half a unit. (The affine map itself is
// evaluated in doubles, which adds less than 2^-20 voxels for coordinates below 2^20.)
inline constexpr double kSnapErrorMax = 0.5 / kLatticeUnit;

// Maps p to V^-1 (p - origin), rounded half to even to multiples of 1/kLatticeUnit. Takes over the mesh and rounds its
// vertices in place; or, for a shared mesh, shares its triangles. Once cancelled, the result is meaningless.
//   reach   per axis, the largest |q| of the frames in use, or twice what a cell extends by, for `box`
// Errors: RESOURCE_EXHAUSTED if the extent along an axis exceeds kMaxExtent; INVALID_ARGUMENT if the position exceeds
// 2^kPositionBits.
// Precondition: CheckMesh(mesh).
absl::StatusOr<SnappedMesh> Snap(TriangleMesh mesh, const Lattice& lattice, const Vec3d& origin, const Vec3i& reach,
                                 StopSignal stop = {});
absl::StatusOr<SnappedMesh> Snap(std::shared_ptr<const TriangleMesh> mesh, const Lattice& lattice, const Vec3d& origin,
                                 const Vec3i& reach, StopSignal stop = {});

}  // namespace latvox

#endif  // LATVOX_CORE_SNAP_SNAP_H_
