// Crossed links, sorted into the tiles of their nearer ends. For a supercover, voxels take their places: as nearer ends
// of links along direction 0, whose farther ends mean nothing.
#ifndef LATVOX_CORE_TILE_TILE_LINKS_H_
#define LATVOX_CORE_TILE_TILE_LINKS_H_

#include <hwy/cache_control.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/functional/function_ref.h"
#include "core/base/huge_pages.h"
#include "core/brick/brick.h"
#include "core/tile/tile_bits.h"

namespace latvox {

// Crossed links from nearer[n], a voxel of the surface, to farther[n]. Voxels are numbers of one BitsLayout.
struct Crossings {
  NumberList nearer, farther;

  void Clear() {
    nearer.Clear();
    farther.Clear();
  }
  size_t Bytes() const { return nearer.Bytes() + farther.Bytes(); }
};

// A link in a tile: (nearer end within the tile, as i << 12 | j << 6 | k) << kPackedEndShift | 2 * direction + 1 if it
// goes forward along the direction, and + 0 if backward.
inline constexpr int kPackedEndShift = 5;
inline constexpr size_t kPackedDirections = size_t{1} << kPackedEndShift;
static_assert(3 * kTileBits + kPackedEndShift <= 32);

// A tile relative to the first: i << 20 | j << 10 | k.
inline constexpr int kPackedTileBits = 10;

// Links, with the packed tiles that contain their nearer ends.
struct PackedLinks {
  NumberList tiles, links;

  size_t size() const { return links.size(); }
  void Reserve(size_t more) {
    tiles.Reserve(more);
    links.Reserve(more);
  }
  void Grow(size_t by) {
    tiles.Grow(by);
    links.Grow(by);
  }
  void Clear() {
    tiles.Clear();
    links.Clear();
  }
};

// Memory for many lists that grow at the same time. A list that grows by itself copies its content, and the system
// provides and clears its memory page by page.
class LinkBlocks {
 public:
  static constexpr size_t kLargest = 1024;  // links

  // Returns a block of so many links, indeterminate, which lives as long as this object.
  uint32_t* Next(size_t size);

 private:
  struct alignas(kHugePage) Piece {  // all of one size, so that the heap reuses freed ones
    std::array<uint32_t, kHugePage / sizeof(uint32_t)> links;
  };

  std::unique_ptr<uint32_t[]> first_;  // enough for small meshes
  std::vector<std::unique_ptr<Piece>> pieces_;
  uint32_t *next_ = nullptr, *end_ = nullptr;
};

// Packed links, in blocks, each twice as large as the one before, up to LinkBlocks::kLargest. Most lists may have few
// links, or many.
class LinkList {
 public:
  static constexpr ptrdiff_t kSlack = 16;  // links: a vector's worth

  // Makes room for up to kSlack links at end(), which may move.
  void Reserve(LinkBlocks& memory) {
    if (limit_ - end_ < 2 * kSlack) Extend(memory);
  }
  uint32_t* end() { return end_; }
  void Grow(size_t by) { end_ += by; }

  size_t size() const { return full_size_ + static_cast<size_t>(end_ - begin_); }

  // Calls f(span) for all of them, block by block; behind each block, kSlack more links can be read.
  template <class F>
  void ForEachBlock(F&& f) const {
    for (size_t n = 0; n < full_.size(); ++n) {
      PrefetchHead(n + 1 < full_.size() ? full_[n + 1].data() : begin_);
      f(full_[n]);
    }
    f(std::span<const uint32_t>(begin_, end_));
  }

 private:
  void Extend(LinkBlocks& memory);
  // Prefetches the beginning of a block; processors with a prefetcher of their own predict the rest.
  static void PrefetchHead(const uint32_t* block) {
    constexpr size_t kLine = 16, kLines = 8;
    for (size_t line = 0; line < kLines; ++line) hwy::Prefetch(block + line * kLine);
  }

  std::vector<std::span<const uint32_t>> full_;  // all blocks except the last
  size_t full_size_ = 0;
  uint32_t *begin_ = nullptr, *end_ = nullptr, *limit_ = nullptr;  // of the last
};

// Several threads fill it, then several read it.
class TileLinks {
 public:
  // The links that one thread has found.
  class Part {
   public:
    // Moves all links to their tiles.
    //   margin   voxels, per axis: at most kTileSide / 2
    void Move(PackedLinks& links, const Vec3i& margin);

    // The links of a tile, and copies of those with nearer ends within the margin of the tiles around.
    struct Lists {
      LinkList all, border;
    };
    Lists& ListsOf(uint32_t tile);
    LinkBlocks& memory() { return memory_; }

   private:
    friend class TileLinks;
    struct Recent {
      uint32_t tile = 0;
      Lists* lists = nullptr;
    };
    LinkBlocks memory_;
    PackedLinks border_;  // of Move
    absl::flat_hash_map<uint32_t, std::unique_ptr<Lists>> lists_;
    std::array<Recent, 64> recent_;  // by the lowest bits of a tile's coordinates
  };

  // first_tile  the lowest tile, local
  // margin      for Part::Move
  TileLinks(const Vec3i& first_tile, const Vec3i& margin) : first_tile_(first_tile), margin_(margin) {}

  const Vec3i& first_tile() const { return first_tile_; }
  const Vec3i& margin() const { return margin_; }

  // Returns a part for a thread to fill. Threads: any.
  std::unique_ptr<Part> ReservePart();
  void ReleasePart(std::unique_ptr<Part> part);  // does not throw

  // Call it once all parts are released. The members below are for the time after it.
  void Finish();

  bool empty() const { return tiles_.empty(); }

  // Returns the number of links with nearer ends in the cube of 2^level tiles a side, a subcube of one that begins at
  // the first tile.
  size_t CountIn(const Vec3i& tile_ijk, int level) const;

  // Calls f(crossings) with the links whose nearer ends lie in `box`, a box around the tiles of `block`: some kBatch at
  // a time, always in the same order. It is cheaper to unpack them anew each time than to keep them.
  //   steps  by packed direction, in numbers of the layout
  void ForEachBatch(const IndexBox& block, const IndexBox& box, const BitsLayout& layout,
                    const std::array<int32_t, kPackedDirections>& steps,
                    absl::FunctionRef<void(const Crossings&)> f) const;

 private:
  // A part's lists of a tile, by the tile's place in the canonical order.
  struct Tile {
    uint64_t number;
    const Part::Lists* lists;
    size_t before;  // links in the tiles before this
  };
  static constexpr size_t kBatch = 2048;  // links: less than fits a core's first-level cache

  std::vector<Tile>::const_iterator From(uint64_t number) const;

  const Vec3i first_tile_, margin_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Part>> parts_;
  size_t made_ = 0;          // parts; parts_ has room for them
  std::vector<Tile> tiles_;  // ascending
  size_t size_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_TILE_TILE_LINKS_H_
