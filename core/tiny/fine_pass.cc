#include "core/tiny/fine_pass.h"

#include <oneapi/tbb/blocked_range.h>

#include <algorithm>
#include <memory>

#include "core/base/metered.h"
#include "core/base/simd.h"
#include "core/tiny/line_forms.h"
#include "core/tiny/tiny.h"
#include "core/tiny/tiny_cover.h"
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
//   Find   takes a list of triangles. It appends the numbers of the kept triangles to another list
template <class Find>
class ChunkPass {
 public:
  //   origin  of lists of corners
  ChunkPass(const SnappedMesh& mesh, const Vec3i& origin, Find& find) : mesh_(mesh), origin_(origin), find_(find) {}

  Chunk Do(size_t begin, size_t end) {
    Chunk chunk;
    kept_.clear();
    for (size_t first = begin; first < end; first += CornerList::kMost) {
      chunk.sums.AddAndList(mesh_, first, std::min(CornerList::kMost, end - first), origin_, *list_);
      find_(*list_, kept_);
    }
    chunk.kept = kept_;  // no larger than necessary
    return chunk;
  }

 private:
  const SnappedMesh& mesh_;
  const Vec3i origin_;
  Find& find_;
  const std::unique_ptr<CornerList> list_ = std::make_unique<CornerList>();
  std::vector<uint32_t> kept_;
};

// Goes through the mesh with all threads of the arena.
//   make_find   makes a Find for a thread's chunks, which fills `links`
template <class MakeFind>
FineTriangles SortOut(const SnappedMesh& mesh, StopSignal stop, TileLinks& links, const MakeFind& make_find) {
  const size_t count = mesh.triangles.size();
  const Vec3i origin = TinyCrossings::Origin(links);
  std::vector<Chunk> chunks((count + kChunk - 1) / kChunk);
  MeteredFor(oneapi::tbb::blocked_range<size_t>(0, chunks.size()), [&](const auto& numbers) {
    auto find = make_find();
    ChunkPass pass(mesh, origin, find);
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

// Leaves out triangles that no line can meet, and finds the links of tiny ones.
struct FindLinks {
  const LineForms& forms;
  bool few_touch;
  uint8_t* marks;                       // of is_tiny, or null
  std::unique_ptr<TinyCrossings> tiny;  // null: no triangle counts as tiny

  void operator()(CornerList& list, std::vector<uint32_t>& kept) {
    if (marks != nullptr) std::fill_n(marks + list.triangles[0], list.size, 1);  // also if no line can meet them
    if (few_touch) KeepTouching(forms, list);
    if (tiny) {
      tiny->Find(list, kept, marks);
    } else {
      kept.insert(kept.end(), list.triangles, list.triangles + list.size);
    }
  }
};

// Finds the cells of tiny triangles.
struct FindCover {
  TinyCover tiny;

  void operator()(const CornerList& list, std::vector<uint32_t>& kept) { tiny.Find(list, kept); }
};

}  // namespace

bool CanFindTiny(const SnappedMesh& mesh, const TileLinks& links) {
  if (SimdIsScalar() || TileCubeLevel(mesh.box) > kPackedTileBits) return false;
  // The box consists of voxels with a half-link to the mesh, so it may begin one voxel above it.
  const Vec3i extent = mesh.box.max - TinyCrossings::Origin(links);
  return std::max({extent[0], extent[1], extent[2]}) < CornerList::kVoxels;
}

FineTriangles SortOutFine(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const Fineness& fineness,
                          const IndexBox& box, StopSignal stop, TileLinks& links,
                          UninitializedVector<uint8_t>* is_tiny) {
  const bool find_tiny = fineness.most_tiny && CanFindTiny(mesh, links);
  uint8_t* marks = nullptr;
  if (find_tiny && is_tiny != nullptr) {
    is_tiny->resize(mesh.triangles.size());
    marks = is_tiny->data();
  }
  const LineForms forms(frames);
  return SortOut(mesh, stop, links, [&] {
    return FindLinks{forms, fineness.few_touch, marks,
                     find_tiny ? std::make_unique<TinyCrossings>(frames, box, links) : nullptr};
  });
}

FineTriangles SortOutFineCover(const SnappedMesh& mesh, const IndexBox& box, StopSignal stop, TileLinks& links) {
  return SortOut(mesh, stop, links, [&] { return FindCover{TinyCover(box, links)}; });
}

}  // namespace latvox
