// The candidates of a block's triangles, all at once or part by part.
#ifndef LATVOX_CORE_BLOCK_CANDIDATE_PARTS_H_
#define LATVOX_CORE_BLOCK_CANDIDATE_PARTS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/block/block_box.h"
#include "core/block/tile_context.h"
#include "core/scan/candidates.h"

namespace latvox {

// Many large triangles in one block would fill the memory. Their candidates are found part by part, and found again
// each time that thinning needs them. The candidates of few triangles are a single part, which is kept. Twice as many
// candidates in a part would make 2,000 wires at 256 voxels 15 % faster, but take 40 MB more for each thread.
class CandidateParts {
 public:
  // Begins a block.
  //   triangles   must live until the block is done, as must `frames`
  //   frames      along whose directions the triangles are scanned
  void Reset(std::span<const uint32_t> triangles, const std::vector<ScanFrame>& frames) {
    triangles_ = triangles;
    frames_ = &frames;
    kept_ = false;
    candidates_.Clear();
  }

  // Calls f(candidates) with each part. The first call for a block has a part even without triangles. Skips parts once
  // the job is cancelled.
  template <class F>
  void ForEach(const TileContext& context, const BlockBox& where, F&& f) {
    constexpr size_t kEnough = size_t{1} << 21;
    if (kept_) return f(candidates_);
    const SearchLimits limits{where.box, where.layout, context.stop, kEnough};
    size_t end = 0;
    do {
      const size_t begin = end;
      candidates_.Clear();
      end += FindCandidates(context.mesh, triangles_.subspan(begin), *frames_, limits, candidates_);
      kept_ = begin == 0 && end >= triangles_.size();
      f(candidates_);
    } while (end < triangles_.size() && !context.stop.Stopped());
  }

  // Whether a single part has been kept; then its size.
  bool IsWhole() const { return kept_; }
  size_t size() const { return candidates_.size(); }

  size_t Bytes() const { return candidates_.Bytes(); }

 private:
  std::span<const uint32_t> triangles_;
  const std::vector<ScanFrame>* frames_ = nullptr;
  Candidates candidates_;
  bool kept_ = false;  // whether they belong to all triangles
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_CANDIDATE_PARTS_H_
