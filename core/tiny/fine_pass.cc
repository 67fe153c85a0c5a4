#include "core/tiny/fine_pass.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "core/base/simd.h"
#include "core/tiny/line_forms.h"
#include "core/tiny/tiny.h"
#include "core/tiny/touching.h"
#include "core/tree/tile_tree.h"
#include "core/triangles/corner_list.h"

namespace latvox {
namespace {

constexpr size_t kChunk = 1 << 14;  // triangles

// The results for one chunk of the mesh.
struct Chunk {
  std::vector<uint32_t> kept;
  SurfaceSums sums;
};

// Goes through chunks, one after the other, in one thread.
class ChunkPass {
 public:
  //   origin  of lists of corners
  //   tiny    null: no triangle counts as tiny
  //   marks   of is_tiny, or null
  ChunkPass(const SnappedMesh& mesh, const LineForms& forms, bool few_touch, const Vec3i& origin, TinyCrossings* tiny,
            uint8_t* marks)
      : mesh_(mesh), forms_(forms), few_touch_(few_touch), origin_(origin), tiny_(tiny), marks_(marks) {}

  Chunk Do(size_t begin, size_t end) {
    Chunk chunk;
    kept_.clear();
    if (marks_ != nullptr) std::fill(marks_ + begin, marks_ + end, 1);  // also for triangles that no line can meet
    for (size_t first = begin; first < end; first += CornerList::kMost) {
      chunk.sums.AddAndList(mesh_, first, std::min(CornerList::kMost, end - first), origin_, *list_);
      if (few_touch_) KeepTouching(forms_, *list_);
      if (tiny_ != nullptr) {
        tiny_->Find(*list_, kept_, marks_);
      } else {
        kept_.insert(kept_.end(), list_->triangles, list_->triangles + list_->size);
      }
    }
    chunk.kept = kept_;  // no larger than necessary
    return chunk;
  }

 private:
  const SnappedMesh& mesh_;
  const LineForms& forms_;
  const bool few_touch_;
  const Vec3i origin_;
  TinyCrossings* const tiny_;
  uint8_t* const marks_;
  const std::unique_ptr<CornerList> list_ = std::make_unique<CornerList>();
  std::vector<uint32_t> kept_;
};

}  // namespace

FineTriangles SortOutFine(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const Fineness& fineness,
                          const IndexBox& box, StopSignal stop, TileLinks& links,
                          UninitializedVector<uint8_t>* is_tiny) {
  const size_t count = mesh.triangles.size();
  const Vec3i origin = TinyCrossings::Origin(links);
  bool find_tiny = fineness.most_tiny && !SimdIsScalar() && TileCubeLevel(mesh.box) <= kPackedTileBits;
  // The box consists of voxels with a half-link to the mesh, so it may begin one voxel above it.
  for (size_t m = 0; m < 3; ++m) find_tiny &= mesh.box.max[m] - origin[m] < CornerList::kVoxels;
  uint8_t* marks = nullptr;
  if (find_tiny && is_tiny != nullptr) {
    is_tiny->resize(count);
    marks = is_tiny->data();
  }
  const LineForms forms(frames);
  std::vector<Chunk> chunks((count + kChunk - 1) / kChunk);
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<size_t>(0, chunks.size()), [&](const auto& numbers) {
    std::optional<TinyCrossings> tiny;
    if (find_tiny) tiny.emplace(frames, box, links);
    ChunkPass pass(mesh, forms, fineness.few_touch, origin, tiny ? &*tiny : nullptr, marks);
    for (size_t n = numbers.begin(); n < numbers.end() && !stop.Stopped(); ++n) {
      chunks[n] = pass.Do(n * kChunk, std::min((n + 1) * kChunk, count));
    }
  });
  links.Finish();

  SurfaceSums sums;
  size_t size = 0;
  for (const Chunk& chunk : chunks) {
    sums.Add(chunk.sums);
    size += chunk.kept.size();
  }
  FineTriangles fine{{}, sums.Facts()};
  fine.kept.reserve(size);
  for (const Chunk& chunk : chunks) fine.kept.insert(fine.kept.end(), chunk.kept.begin(), chunk.kept.end());
  return fine;
}

}  // namespace latvox
