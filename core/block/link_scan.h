// The links of a block that the mesh crosses, from the triangles around it.
#ifndef LATVOX_CORE_BLOCK_LINK_SCAN_H_
#define LATVOX_CORE_BLOCK_LINK_SCAN_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/block/block_box.h"
#include "core/block/candidate_parts.h"
#include "core/block/tile_context.h"
#include "core/scan/stars.h"
#include "core/tree/tile_tree.h"

namespace latvox {

// A triangle crosses a link at the nearer half of one of its ends. So the links with an end in the block have their
// nearer ends in the block with a halo of one step. All these are among the candidates of the triangle
// (core/digitize/principal_scan.h), each once, and the star of a candidate has all its links. So each pair of a link
// and a triangle that crosses it comes exactly once, in an order without meaning.
//
// Reuses the memory of one node for the next. Leaves part of the work undone once the job is cancelled.
class LinkScan {
 public:
  // Begins a block.
  //   context     its reach is that of the frames
  //   triangles   all that come within a step of the node; more do no harm. Must live until the node is done
  void Begin(const TileContext& context, const TileNode& node, std::span<const uint32_t> triangles) {
    where_ = BlockBox(context, node, 1);
    candidates_.Reset(triangles, context.frames);
  }

  const BlockBox& where() const { return where_; }

  // Calls f(pair, star) for all pairs of a voxel and a triangle whose star has a link.
  template <class F>
  void ForEachStar(const TileContext& context, F&& f) {
    candidates_.ForEach(context, where_, [&](const Candidates& candidates) {
      uint32_t crossed = 0, rim = 0;
      for (const Candidates::Run& run : candidates.runs) {
        AskRun(context, candidates, run, candidates.nearer, crossed, run.crossed_end, f);
        AskRun(context, candidates, run, candidates.rim, rim, run.rim_end, f);
        crossed = run.crossed_end;
        rim = run.rim_end;
      }
      Ask(context, f);
    });
  }

  // Bytes of memory.
  size_t Bytes() const { return candidates_.Bytes(); }

 private:
  static constexpr size_t kBatch = 64;

  template <class F>
  void AskRun(const TileContext& context, const Candidates& candidates, const Candidates::Run& run,
              const NumberList& voxels, uint32_t begin, uint32_t end, F& f) {
    for (uint32_t n = begin; n < end; ++n) {
      batch_[size_++] = {voxels[n] & kNumberMask, candidates.TriangleAt(run, voxels[n] >> kNumberBits)};
      if (size_ == kBatch) Ask(context, f);
    }
  }

  template <class F>
  void Ask(const TileContext& context, F& f) {
    if (!context.stop.Stopped()) {
      FindStarLinks(context.mesh, context.frames, where_.layout, {batch_.data(), size_}, stars_.data());
      for (size_t n = 0; n < size_; ++n) {
        if (stars_[n].nearer != 0) f(batch_[n], stars_[n]);
      }
    }
    size_ = 0;
  }

  BlockBox where_;
  CandidateParts candidates_;
  std::array<VoxelTriangle, kBatch> batch_;
  std::array<StarLinks, kBatch> stars_;
  size_t size_ = 0;  // of the batch
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_LINK_SCAN_H_
