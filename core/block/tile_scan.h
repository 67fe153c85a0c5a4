// The voxels of a box from the triangles around it, and what thinning asks for.
#ifndef LATVOX_CORE_BLOCK_TILE_SCAN_H_
#define LATVOX_CORE_BLOCK_TILE_SCAN_H_

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/brick/brick.h"
#include "core/digitize/principal_scan.h"
#include "core/scan/candidates.h"
#include "core/scan/stars.h"
#include "core/snap/snap.h"
#include "core/supercover/supercover.h"
#include "core/thin/crossed_edges.h"
#include "core/thin/thin.h"
#include "core/tile/tile_bits.h"
#include "core/tile/tile_edges.h"
#include "core/tree/tile_tree.h"

namespace latvox {

// The steps around a tile that thinning looks at first, which nearly always decides.
inline constexpr int32_t kNearHalo = 2;

// What all tiles of a job have in common.
struct TileContext {
  const SnappedMesh& mesh;
  const std::vector<ScanFrame>& frames;
  const Supercover* supercover;  // if that is asked for; else null. It is not thinned
  Vec3i reach;                   // per axis, the largest |q| of the frames, or the supercover's margin
  bool minimal;                  // whether to thin
  const TileEdges& edges;        // of tiny triangles, if most are tiny; set before the first tile
  // Which triangles these are, if nodes list them, too, else empty.
  const UninitializedVector<uint8_t>& is_tiny;
  IndexBox region;  // local voxels outside are not delivered
  StopSignal stop;

  // How far, per axis, triangles may lie outside of a tile and still matter to it, in voxels: at first, and at all.
  Vec3i NearMargin() const { return reach * (minimal ? kNearHalo + 1 : 1); }
  Vec3i FarMargin() const { return reach * (minimal ? kThinHalo + 1 : 1); }
};

// The surface in a box of voxels. What a thread allocates for one node serves it for the next.
class TileScan {
 public:
  // Finds all voxels of the surface in the box of `halo` steps around the node.
  //   triangles   all that come within half a step of the box, but for those whose edges the context has; more do no
  //               harm. Must live until the node is done
  // Leaves part of it undone once the job is cancelled.
  void Scan(const TileContext& context, const TileNode& node, int32_t halo, std::span<const uint32_t> triangles);

  // Removes redundant voxels; returns whether that was decided for the whole node. See Thin.
  bool Thin(const TileContext& context);

  // Adds the voxels of a tile (local) of the node: bit k of rows[i << 6 | j].
  void AddRows(const Vec3i& tile_ijk, std::span<const uint64_t> rows);

  // The bricks of a tile (local) of the node in lexicographic order, in global coordinates, without voxels outside of
  // context.region.
  TileBricks CutOut(const TileContext& context, const Vec3i& tile_ijk) const;

  // Of memory.
  size_t Bytes() const;

 private:
  template <class F>
  void ForEachTinyBatch(const TileContext& context, F&& f) const;
  void Use(std::span<const uint32_t> voxels);
  void UsePlanes(const NumberRange& voxels);
  void CoverAll(const TileContext& context);
  size_t Gather(const TileContext& context, size_t begin);
  template <class F>
  void ForEachPart(const TileContext& context, F&& f);
  template <class F>
  void ForEachStar(const TileContext& context, const TileBits& bits, bool in_set, F&& f);
  void AddRim(const TileContext& context);
  template <class F>
  bool ForEachEnd(uint32_t voxel, const StarEdges& star, F&& f) const;
  void AddInner(const Crossings& some, const TileBits& bits, bool in_set);
  void FindRest(const TileContext& context);
  bool IsOutside(uint32_t voxel) const;
  void AskRest(const TileContext& context);
  void AskRestOfPart(const TileContext& context);
  bool FindPairsByBoxes();
  void AskPairs(const TileContext& context);
  void UpdateMaybe();
  void FindInRest(const NumberList& voxels);
  void AskAtPositions(const TileContext& context, const NumberList& voxels, uint32_t Candidates::Run::*run_end);
  void AddBorder(const TileContext& context, std::span<const uint32_t> members);

  IndexBox block_{}, box_{};  // the node's voxels, and with the halo
  BitsLayout layout_{{}, {}};
  std::array<int32_t, kMaxDirections> steps_{};  // of layout_, along the frames
  TileBits surface_{0};
  NumberRange used_;                     // of surface_: all members that it has had for this node lie there,
  IndexBox used_box_{};                  // and here
  TileBits essential_{0};                // what edges of tiny triangles have shown to be; empty from node to node
  TileBits rest_{0};                     // members of surface_ that nothing has shown essential yet; likewise
  std::span<const uint32_t> triangles_;  // what Scan was given, or others_
  std::vector<uint32_t> others_;         // those of its triangles that are not tiny
  Candidates candidates_;                // of triangles_, or of the part of them at hand
  bool in_parts_ = false;
  NumberList positions_;
  Crossings inside_;    // edges of tiny triangles with both ends in surface_
  NumberList outward_;  // the nearer ends of others
  Crossings inner_;     // of tiny triangles, from members of rest_, or from what may become some
  struct RimVoxel {
    uint32_t voxel;
    StarEdges star;
  };
  std::vector<uint32_t> added_;     // the voxels of AddRim
  std::vector<RimVoxel> rim_only_;  // members that no triangle crosses along its principal direction
  std::vector<uint32_t> maybe_;     // all of rest_, each once, and others
  std::vector<VoxelTriangle> pairs_;
  CrossedEdges edges_;  // between members of rest_
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_TILE_SCAN_H_
