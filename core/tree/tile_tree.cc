// A counting sort. The octants near each triangle are listed and counted, chunk by chunk of the triangles. Sums of the
// counts give each chunk's places in the octants' lists, and then the triangles go there. Chunks are independent. The
// lists are ascending, because chunks are.
#include "core/tree/tile_tree.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "core/base/metered.h"
#include "core/base/uninitialized.h"

namespace latvox {
namespace {

// Nodes with fewer triangles are sorted as one chunk, others as no more than kMaxChunks.
constexpr size_t kMinParallel = 8192;
constexpr size_t kMinChunk = 4096;
constexpr size_t kMaxChunks = 64;

// As many levels as leave this many triangles in an octant, because each octant has a cost; but no fewer than
// kFewLevels.
constexpr size_t kTrianglesPerCell = 2;
constexpr int kFewLevels = 2;

// A triangle may have this many hits on average. Where large triangles have more, children come from fewer levels,
// which bounds the memory.
constexpr size_t kHitsPerTriangle = 6;
constexpr size_t kFewHits = 4096;

template <class F>
void ForEachOf(size_t count, const F& f) {
  if (count == 1) return f(0);
  // Without isolation, a waiting thread might begin other work of the caller's.
  oneapi::tbb::this_task_arena::isolate([&] {
    MeteredFor(oneapi::tbb::blocked_range<size_t>(0, count), [&](const auto& numbers) {
      for (size_t n = numbers.begin(); n < numbers.end(); ++n) f(n);
    });
  });
}

// Returns the octant with that number in Morton order.
Vec3i OctantAt(size_t number) {
  Vec3i octant{};
  for (int bit = 0; bit < kMaxGridLevels; ++bit) {
    for (int m = 0; m < 3; ++m) {
      octant[static_cast<size_t>(m)] |= static_cast<int32_t>(number >> (3 * bit + 2 - m) & 1) << bit;
    }
  }
  return octant;
}

int LevelsBelow(int level, size_t triangles) {
  int levels = std::min(level, kMaxGridLevels);
  while (levels > kFewLevels && triangles >> 3 * levels < kTrianglesPerCell) --levels;
  return levels;
}

}  // namespace

// Counts hits. A count must wait for the one before it if both are of the same hit, which is likely. So neighbors in
// the list are counted apart.
class TileTree::HitCounts {
 public:
  //   no_hit   the largest hit
  explicit HitCounts(OctantHit no_hit) : even_(size_t{no_hit} + 1), odd_(even_.size()) {}

  void Add(std::span<const OctantHit> hits) {
    const auto octant = [&](size_t n) { return static_cast<size_t>(hits[n] & ~kLastHit); };
    for (size_t n = 0; n + 1 < hits.size(); n += 2) {
      ++even_[octant(n)];
      ++odd_[octant(n + 1)];
    }
    if (hits.size() % 2 != 0) ++even_[octant(hits.size() - 1)];
  }

  std::vector<uint32_t> Sum() {
    std::transform(even_.begin(), even_.end(), odd_.begin(), even_.begin(), std::plus());
    return std::move(even_);
  }

 private:
  std::vector<uint32_t> even_, odd_;
};

// Some of a node's triangles, near ones and fringe, and the octants that they hit.
struct TileTree::Chunk {
  uint32_t first = 0;             // if ids == nullptr, the triangles are first, first + 1, ...
  const uint32_t* ids = nullptr;  // ascending
  size_t size = 0;
  UninitializedVector<uint32_t> merged{};  // of near ones and fringe, if there are both
  UninitializedVector<OctantHit> hits{};   // one triangle's after the other's
  std::vector<uint32_t> counts{};          // by hit; later where in that octant's list the next triangle goes

  uint32_t Triangle(size_t n) const { return ids == nullptr ? first + static_cast<uint32_t>(n) : ids[n]; }
};

int TileCubeLevel(const IndexBox& box) {
  int32_t tiles = 1;
  for (size_t m = 0; m < 3; ++m) {
    tiles = std::max(tiles, ((box.max[m] - 1) >> kTileBits) - (box.min[m] >> kTileBits) + 1);
  }
  int level = 0;
  while ((1 << level) < tiles) ++level;
  return level;
}

std::vector<TileNode> TileTree::Top(std::optional<std::vector<uint32_t>> triangles) const {
  if (triangles && triangles->empty() && !keep_empty_ && (links_ == nullptr || links_->empty())) return {};
  // The cube begins at the lowest tile of the whole mesh, whatever the region, so that the order is always the same.
  TileNode root{{}, level(), {}, {}, 0, 1};
  for (size_t m = 0; m < 3; ++m) {
    if (region_.min[m] >= region_.max[m]) return {};
    root.tile_ijk[m] = mesh_.box.min[m] >> kTileBits;
  }
  root.links = LinksIn(root.tile_ijk, root.level);
  if (triangles) {
    root.triangles = *std::move(triangles);
    return Split(root, root.triangles.size(), leaf_level_);
  }
  return Split(root, mesh_.triangles.size(), leaf_level_);
}

std::vector<TileNode> TileTree::Children(const TileNode& node) const {
  return Split(node, node.triangles.size(), IsLeaf(node) ? 0 : leaf_level_);
}

// `triangles` is the number of the node's triangles, or of all if the node lists none.
std::vector<TileNode> TileTree::Split(const TileNode& node, size_t triangles, int leaf_level) const {
  for (int levels = LevelsBelow(std::max(node.level - leaf_level, 0), triangles + node.links);; --levels) {
    const size_t max_hits = levels > 1 ? std::max(kFewHits, kHitsPerTriangle * (triangles + node.fringe.size()))
                                       : std::numeric_limits<size_t>::max();
    if (auto children = SplitBy(levels, node, triangles, max_hits)) return *std::move(children);
  }
}

// Returns nullopt if there are more than max_hits.
std::optional<std::vector<TileNode>> TileTree::SplitBy(int levels, const TileNode& node, size_t triangles,
                                                       size_t max_hits) const {
  const OctantGrid grid(node.tile_ijk, node.level, levels, near_, far_, region_);
  if (grid.IsEmpty()) return std::vector<TileNode>{};
  const size_t octants = size_t{1} << 3 * levels;

  const size_t count = triangles < kMinParallel ? 1 : std::min(kMaxChunks, triangles / kMinChunk);
  const auto part = [&](size_t all, size_t n) { return all * n / count; };
  std::vector<Chunk> chunks(count);
  std::atomic<size_t> total_hits = 0;
  ForEachOf(count, [&](size_t n) {
    SetTriangles(node, part(triangles, n), part(triangles, n + 1), chunks[n]);
    FindHits(grid, max_hits, total_hits, chunks[n]);
  });
  if (stop_.Stopped()) return std::vector<TileNode>{};
  if (total_hits > max_hits) return std::nullopt;

  std::vector<uint32_t> sizes(2 * octants);
  ForEachOf(count, [&](size_t n) { AddCounts(part(2 * octants, n), part(2 * octants, n + 1), chunks, sizes); });
  std::vector<TileNode> children;
  std::vector<size_t> numbers;
  size_t total = 0;
  for (size_t octant = 0; octant < octants; ++octant) {
    const int level = node.level - levels;
    const Vec3i tile_ijk = node.tile_ijk + OctantAt(octant) * (1 << level);
    const size_t links = LinksIn(tile_ijk, level);
    if (sizes[2 * octant] == 0 && links == 0 && !(keep_empty_ && MeetsRegion(tile_ijk, level))) continue;
    children.push_back({tile_ijk, level, {}, {}, 0, 0, links});
    numbers.push_back(octant);
    total += sizes[2 * octant] + links;
  }
  double progress = node.progress;
  for (size_t n = 0; n < children.size(); ++n) {
    children[n].progress = progress;
    const size_t weight = total > 0 ? sizes[2 * numbers[n]] + children[n].links : 1;
    const size_t all = total > 0 ? total : children.size();
    children[n].share = node.share * static_cast<double>(weight) / static_cast<double>(all);
    progress += children[n].share;
  }

  std::vector<uint32_t*> lists(2 * octants + 1);  // null where no child is
  ForEachOf(count, [&](size_t p) {
    for (size_t n = part(children.size(), p); n < part(children.size(), p + 1); ++n) {
      children[n].triangles.resize(sizes[2 * numbers[n]]);
      children[n].fringe.resize(sizes[2 * numbers[n] + 1]);
      lists[2 * numbers[n]] = children[n].triangles.data();
      lists[2 * numbers[n] + 1] = children[n].fringe.data();
    }
  });
  ForEachOf(count, [&](size_t n) {
    if (!stop_.Stopped()) Fill(lists.data(), chunks[n]);
  });
  return children;
}

// Tiles that are not delivered do not count.
size_t TileTree::LinksIn(const Vec3i& tile_ijk, int level) const {
  return links_ != nullptr && MeetsRegion(tile_ijk, level) ? links_->CountIn(tile_ijk, level) : 0;
}

bool TileTree::MeetsRegion(const Vec3i& tile_ijk, int level) const {
  for (size_t m = 0; m < 3; ++m) {
    const int32_t low = tile_ijk[m] * kTileSide, high = low + (kTileSide << level);
    if (low >= region_.max[m] || high <= region_.min[m]) return false;
  }
  return true;
}

// Fills the chunk with a node's triangles begin .. end - 1, and the fringe between them. If the node lists none, all
// triangles of the mesh are meant.
void TileTree::SetTriangles(const TileNode& node, size_t begin, size_t end, Chunk& chunk) {
  chunk.first = static_cast<uint32_t>(begin);
  chunk.size = end - begin;
  if (node.triangles.empty() && node.fringe.empty()) return;
  chunk.ids = node.triangles.data() + begin;
  const auto fringe_before = [&](size_t n) {
    return std::lower_bound(node.fringe.begin(), node.fringe.end(), node.triangles[n]);
  };
  const auto fringe = begin == 0 ? node.fringe.begin() : fringe_before(begin);
  const auto fringe_end = end == node.triangles.size() ? node.fringe.end() : fringe_before(end);
  if (fringe == fringe_end) return;
  chunk.merged.resize(chunk.size + static_cast<size_t>(fringe_end - fringe));
  std::merge(chunk.ids, chunk.ids + chunk.size, fringe, fringe_end, chunk.merged.begin());
  chunk.ids = chunk.merged.data();
  chunk.size = chunk.merged.size();
}

// Leaves the chunk undone if the job is cancelled, or if the sum of all chunks' hits exceeds max_hits.
void TileTree::FindHits(const OctantGrid& grid, size_t max_hits, std::atomic<size_t>& total, Chunk& chunk) const {
  chunk.hits.resize(chunk.size + chunk.size / 4 + kFewHits);
  size_t size = 0, reported = 0;
  const auto may_go_on = [&] {
    total += size - std::exchange(reported, size);
    return total <= max_hits && !stop_.Stopped();
  };
  const auto make_room = [&](size_t room) {
    if (chunk.hits.size() - size >= room) return true;
    if (!may_go_on()) return false;
    chunk.hits.resize(chunk.hits.size() + chunk.hits.size() / 2 + room);
    return true;
  };
  if (!may_go_on()) return;
  HitCounts counts(grid.NoHit());
  OctantGrid::Codes codes;
  std::array<uint32_t, OctantGrid::kBlock> all_ids;
  for (size_t block = 0; block < chunk.size; block += OctantGrid::kBlock) {
    const size_t in_block = std::min(OctantGrid::kBlock, chunk.size - block), before = size;
    const uint32_t* ids = chunk.ids == nullptr ? all_ids.data() : chunk.ids + block;
    if (chunk.ids == nullptr) std::iota(all_ids.begin(), all_ids.end(), chunk.Triangle(block));
    grid.Encode(mesh_, vertices_, {ids, in_block}, codes);
    for (size_t n = 0;; ++n) {
      if (stop_.Stopped() || !make_room(OctantGrid::kMostHits * in_block)) return;
      OctantHit* end = chunk.hits.data() + size;
      n = OctantGrid::FewHits(codes, n, end);
      size = static_cast<size_t>(end - chunk.hits.data());
      if (n == in_block) break;
      const auto [a, b, c] = mesh_.triangles[ids[n]];
      std::vector<OctantHit> many =
          grid.ManyHits({mesh_.vertices_lat[a], mesh_.vertices_lat[b], mesh_.vertices_lat[c]});
      if (many.empty()) many.push_back(grid.NoHit());
      many.back() |= kLastHit;
      if (!make_room(many.size())) return;
      std::copy(many.begin(), many.end(), chunk.hits.data() + size);
      size += many.size();
    }
    counts.Add({chunk.hits.data() + before, size - before});
  }
  chunk.counts = counts.Sum();
  may_go_on();
}

// Adds up all chunks' counts of the hits first .. last - 1, and replaces each by the sum before it.
void TileTree::AddCounts(size_t first, size_t last, std::vector<Chunk>& chunks, std::vector<uint32_t>& sums) {
  for (Chunk& chunk : chunks) {
    for (size_t hit = first; hit < last; ++hit) {
      const uint32_t before = sums[hit];
      sums[hit] += chunk.counts[hit];
      chunk.counts[hit] = before;
    }
  }
}

// Puts the chunk's triangles into the lists of the octants that they hit.
void TileTree::Fill(uint32_t* const* lists, Chunk& chunk) {
  uint32_t* const next = chunk.counts.data();
  const OctantHit* hits = chunk.hits.data();
  for (size_t n = 0; n < chunk.size; ++hits) {
    const size_t hit = *hits & ~kLastHit;
    if (uint32_t* list = lists[hit]) list[next[hit]++] = chunk.Triangle(n);
    n += (*hits & kLastHit) != 0;
  }
}

}  // namespace latvox
