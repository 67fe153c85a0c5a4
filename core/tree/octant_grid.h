// The octants of a grid of cubes that a triangle concerns.
#ifndef LATVOX_CORE_TREE_OCTANT_GRID_H_
#define LATVOX_CORE_TREE_OCTANT_GRID_H_

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/snap/snap.h"
#include "core/triangles/padded_vertices.h"

namespace latvox {

inline constexpr int kMaxGridLevels = 4;

// An octant that a triangle comes near to: (number << 1 | fringe). Octants are numbered in Morton order, i most
// significant. Fringe means that the triangle comes within the far margin of the octant, but not within the near one.
using OctantHit = uint16_t;

// In a list of hits, triangle after triangle, kLastHit marks each triangle's last hit.
inline constexpr OctantHit kLastHit = 1 << 15;
static_assert(2 << 3 * kMaxGridLevels < kLastHit);

// A cube of tiles, divided into 2^levels octants a side. Octants that do not meet a region do not count.
//
// No hit is missing. A triangle lacks a hit only where its bounding box, or a separating axis with room for rounding,
// shows that it misses the octant's margin. An extra hit does no harm: a scan of more triangles finds the same voxels.
// The hits of a triangle depend on that triangle alone, so neither the order of triangles nor threads matter.
class OctantGrid {
 public:
  //   tile_ijk, level   the cube: its lowest tile, local, and the log2 of its side in tiles
  //   near, far         margins, voxels per axis, near <= far
  //   region            local voxels
  // Precondition: levels <= level, levels <= kMaxGridLevels.
  OctantGrid(const Vec3i& tile_ijk, int level, int levels, const Vec3i& near, const Vec3i& far, const IndexBox& region);

  // Returns whether no octant counts.
  bool IsEmpty() const;

  // The octants near a triangle's bounding box. On most axes there are one or two.
  struct Code {
    // A hit is the bitwise or of a part for each axis. These are the parts of the lowest and of the highest octant.
    struct {
      uint16_t lowest, highest;
    } part[3];
    uint16_t two;      // bit 2 - m: on axis m, the highest octant is another one
    uint16_t is_many;  // not 0: use ManyHits
  };

  // Codes of up to kBlock triangles of the mesh. `vertices` are the mesh's.
  static constexpr size_t kBlock = 128;
  struct Codes {
    alignas(64) std::array<Code, kBlock> of;
    size_t size = 0;
  };
  void Encode(const SnappedMesh& mesh, const PaddedVertices& vertices, std::span<const uint32_t> triangles,
              Codes& out) const;

  // The hit of a triangle without a near octant that counts.
  OctantHit NoHit() const { return static_cast<OctantHit>(bounds_.no_hit); }

  // Writes the hits of the triangles from the code `first` on, up to the next one for ManyHits, which tests separating
  // axes, not the bounding box alone. Returns the index of that one, or codes.size.
  //   end  the place to write to; on return the place after the hits. Needs room for kMostHits a triangle
  static constexpr size_t kMostHits = 8;
  static size_t FewHits(const Codes& codes, size_t first, OctantHit*& end);

  // Returns the hits of the triangle with these corners.
  std::vector<OctantHit> ManyHits(const std::array<Vec3i, 3>& corners) const;

  // Converts the corners of a bounding box to the lowest and highest octant whose margin it meets:
  //   (low - below) >> shift, (high + above) >> shift
  struct Margin {
    Vec3i below, above;
  };
  // The parameters of Encode.
  struct Bounds {
    int shift;  // log2 of an octant's side in lattice units
    Margin near, far;
    Vec3i lowest, highest;  // octants that count
    int32_t no_hit;         // the number after the last octant's
  };

 private:
  class LongTriangle;

  Vec3i low_;                       // of the cube, lattice units
  Vec3i near_margin_, far_margin_;  // lattice units
  Bounds bounds_{};
};

}  // namespace latvox

#endif  // LATVOX_CORE_TREE_OCTANT_GRID_H_
