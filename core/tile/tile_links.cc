// The links of one list of triangles mostly lie in few tiles. They are moved there tile by tile, in vectors.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/tile/tile_links.cc"
#include "core/tile/tile_links.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <utility>

#include "core/base/append_lanes-inl.h"
#include "core/base/table_lanes-inl.h"

namespace latvox {
#ifndef LATVOX_CORE_TILE_TILE_LINKS_CC_ONCE
#define LATVOX_CORE_TILE_TILE_LINKS_CC_ONCE
namespace {

constexpr uint32_t kInTile = kTileSide - 1;

// The distance of the bits of an end's axis from the lowest bit.
constexpr int ShiftOf(size_t axis) { return kPackedEndShift + kTileBits * (2 - static_cast<int>(axis)); }

// The links of so many tiles of a list are moved together; those of further tiles, one by one.
constexpr size_t kFewTiles = 12;

// The place of a tile in a layout, and in a box in it.
struct Placed {
  Vec3i from_box;        // the tile's low corner, from the box's
  bool all_inside;       // of the box
  Vec3i size;            // of the box
  Vec3i stride;          // of numbers
  uint32_t number;       // of the tile's low corner, modulo 2^32
  const int32_t* steps;  // by packed direction
};

}  // namespace
#endif
}  // namespace latvox

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kLanes = HWY_LANES(uint32_t);
static_assert(kLanes <= LinkList::kSlack);
using Numbers = hn::ScalableTag<uint32_t>;

template <class V>
HWY_INLINE V End(V link, size_t axis) {
  const Numbers d;
  return hn::And(hn::ShiftRightSame(link, ShiftOf(axis)), hn::Set(d, kInTile));
}

// Moves the links of the first link's tile to its list, and the others to the front; returns the number of others.
size_t MoveOneTile(uint32_t* tiles, uint32_t* links, size_t size, LinkList& list, LinkBlocks& memory) {
  const Numbers d;
  const auto wanted = hn::Set(d, tiles[0]);
  size_t left = 0;
  for (size_t n = 0; n < size; n += kLanes) {
    const auto tile = hn::LoadU(d, tiles + n), link = hn::LoadU(d, links + n);
    const auto given = hn::FirstN(d, size - n), same = hn::And(given, hn::Eq(tile, wanted));
    list.Reserve(memory);
    list.Grow(AppendLanes(d, link, same, list.end()));
    const SelectedLanes<Numbers> others(d, hn::AndNot(same, given));
    others.Store(tile, tiles + left);
    others.Store(link, links + left);
    left += others.count();
  }
  return left;
}

// Moves all links to their tiles' lists.
void Move(uint32_t* tiles, uint32_t* links, size_t size, LinkList TileLinks::Part::Lists::*list,
          TileLinks::Part& part) {
  for (size_t n = 0; n < kFewTiles && size > 0; ++n) {
    size = MoveOneTile(tiles, links, size, part.ListsOf(tiles[0]).*list, part.memory());
  }
  for (size_t n = 0; n < size; ++n) {
    LinkList& to = part.ListsOf(tiles[n]).*list;
    to.Reserve(part.memory());
    *to.end() = links[n];
    to.Grow(1);
  }
}

// Appends the links within the margin of other tiles to `border`.
void CopyBorder(const PackedLinks& links, const Vec3i& margin, PackedLinks& border) {
  const Numbers d;
  const size_t size = links.size();
  border.Reserve(size);
  for (size_t n = 0; n < size; n += kLanes) {
    const auto tile = hn::LoadU(d, links.tiles.view().data() + n), link = hn::LoadU(d, links.links.view().data() + n);
    const auto given = hn::FirstN(d, size - n);
    auto inner = given;
    for (size_t m = 0; m < 3; ++m) {  // margin <= end < kTileSide - margin; lower values wrap around
      const auto low = hn::Set(d, static_cast<uint32_t>(margin[m]));
      const auto width = hn::Set(d, static_cast<uint32_t>(kTileSide - 2 * margin[m]));
      inner = hn::And(inner, hn::Lt(hn::Sub(End(link, m), low), width));
    }
    const SelectedLanes<Numbers> selected(d, hn::AndNot(inner, given));
    selected.Store(tile, border.tiles.end());
    selected.Store(link, border.links.end());
    border.Grow(selected.count());
  }
}

// Precondition: `out` has room.
//   kAllInside   no link's nearer end is outside of the box
template <bool kAllInside>
HWY_INLINE void UnpackLinks(const Placed& at, std::span<const uint32_t> links, Crossings& out) {
  const Numbers d;
  const LaneTable<kPackedDirections> steps(reinterpret_cast<const uint32_t*>(at.steps));  // modulo 2^32
  uint32_t *nearer = out.nearer.end(), *farther = out.farther.end();
  for (size_t n = 0; n < links.size(); n += kLanes) {
    const auto link = hn::LoadU(d, links.data() + n);
    const auto number = hn::Add(hn::Add(hn::Mul(End(link, 0), hn::Set(d, static_cast<uint32_t>(at.stride[0]))),
                                        hn::Mul(End(link, 1), hn::Set(d, static_cast<uint32_t>(at.stride[1])))),
                                hn::Add(End(link, 2), hn::Set(d, at.number)));
    const auto other = hn::Add(number, steps.At(link));
    if constexpr (kAllInside) {
      hn::StoreU(number, d, nearer);
      hn::StoreU(other, d, farther);
      const size_t count = std::min(kLanes, links.size() - n);
      nearer += count;
      farther += count;
      continue;
    }
    auto inside = hn::FirstN(d, links.size() - n);
    for (size_t m = 0; m < 3; ++m) {
      const auto end = hn::Add(End(link, m), hn::Set(d, static_cast<uint32_t>(at.from_box[m])));
      inside = hn::And(inside, hn::Lt(end, hn::Set(d, static_cast<uint32_t>(at.size[m]))));
    }
    const SelectedLanes<Numbers> selected(d, inside);
    selected.Store(number, nearer);
    selected.Store(other, farther);
    nearer += selected.count();
    farther += selected.count();
  }
  out.nearer.Grow(static_cast<size_t>(nearer - out.nearer.end()));
  out.farther.Grow(static_cast<size_t>(farther - out.farther.end()));
}

void Unpack(const Placed& at, std::span<const uint32_t> links, Crossings& out) {
  at.all_inside ? UnpackLinks<true>(at, links, out) : UnpackLinks<false>(at, links, out);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "core/brick/tile_order.h"

namespace latvox {
namespace {

HWY_EXPORT(CopyBorder);
HWY_EXPORT(Move);
HWY_EXPORT(Unpack);

}  // namespace

// The rest of a piece is lost where the next block does not fit.
uint32_t* LinkBlocks::Next(size_t size) {
  constexpr size_t kFirst = 64 * kLargest;
  static_assert(kHugePage / sizeof(uint32_t) >= kLargest);
  if (size > static_cast<size_t>(end_ - next_) && first_ == nullptr) {
    first_ = std::make_unique_for_overwrite<uint32_t[]>(kFirst);
    next_ = first_.get();
    end_ = next_ + kFirst;
  } else if (size > static_cast<size_t>(end_ - next_)) {
    auto& links = pieces_.emplace_back(std::make_unique_for_overwrite<Piece>())->links;
    AdviseHugePages(links.data(), kHugePage);
    next_ = links.data();
    end_ = next_ + links.size();
  }
  return std::exchange(next_, next_ + size);
}

void LinkList::Extend(LinkBlocks& memory) {
  constexpr size_t kSmallest = 2 * kSlack;  // room for Reserve, and kSlack behind
  const size_t size = std::clamp(2 * static_cast<size_t>(limit_ - begin_), kSmallest, LinkBlocks::kLargest);
  if (end_ != begin_) full_.emplace_back(begin_, end_);
  full_size_ += static_cast<size_t>(end_ - begin_);
  begin_ = end_ = memory.Next(size);
  limit_ = begin_ + size;
}

// The same few tiles are needed again and again: those around one place.
TileLinks::Part::Lists& TileLinks::Part::ListsOf(uint32_t tile) {
  Recent& recent = recent_[(tile >> 2 * kPackedTileBits & 3) << 4 | (tile >> kPackedTileBits & 3) << 2 | (tile & 3)];
  if (recent.lists == nullptr || recent.tile != tile) {
    std::unique_ptr<Lists>& lists = lists_[tile];
    if (lists == nullptr) lists = std::make_unique<Lists>();
    recent = {tile, lists.get()};
  }
  return *recent.lists;
}

void TileLinks::Part::Move(PackedLinks& links, const Vec3i& margin) {
  border_.Clear();
  if (margin != Vec3i{}) HWY_DYNAMIC_DISPATCH(CopyBorder)(links, margin, border_);
  HWY_DYNAMIC_DISPATCH(Move)(links.tiles.data(), links.links.data(), links.size(), &Lists::all, *this);
  HWY_DYNAMIC_DISPATCH(Move)(border_.tiles.data(), border_.links.data(), border_.size(), &Lists::border, *this);
  links.Clear();
}

std::unique_ptr<TileLinks::Part> TileLinks::ReservePart() {
  const std::lock_guard lock(mutex_);
  if (parts_.empty()) {
    parts_.reserve(++made_);
    return std::make_unique<Part>();
  }
  std::unique_ptr<Part> part = std::move(parts_.back());
  parts_.pop_back();
  return part;
}

void TileLinks::ReleasePart(std::unique_ptr<Part> part) {
  const std::lock_guard lock(mutex_);
  parts_.push_back(std::move(part));
}

void TileLinks::Finish() {
  constexpr uint32_t kMask = (1U << kPackedTileBits) - 1;
  for (const std::unique_ptr<Part>& part : parts_) {
    for (const auto& [tile, lists] : part->lists_) {
      const Vec3i relative{static_cast<int32_t>(tile >> 2 * kPackedTileBits),
                           static_cast<int32_t>(tile >> kPackedTileBits & kMask), static_cast<int32_t>(tile & kMask)};
      tiles_.push_back({TileNumber(relative), lists.get(), 0});
    }
  }
  std::sort(tiles_.begin(), tiles_.end(), [](const Tile& a, const Tile& b) { return a.number < b.number; });
  for (Tile& tile : tiles_) {
    tile.before = size_;
    size_ += tile.lists->all.size();
  }
}

std::vector<TileLinks::Tile>::const_iterator TileLinks::From(uint64_t number) const {
  return std::lower_bound(tiles_.begin(), tiles_.end(), number,
                          [](const Tile& tile, uint64_t n) { return tile.number < n; });
}

size_t TileLinks::CountIn(const Vec3i& tile_ijk, int level) const {
  const uint64_t first = TileNumber(tile_ijk - first_tile_);
  const auto before = [&](uint64_t number) {
    const auto tile = From(number);
    return tile == tiles_.end() ? size_ : tile->before;
  };
  return before(first + (uint64_t{1} << 3 * level)) - before(first);
}

void TileLinks::ForEachBatch(const IndexBox& block, const IndexBox& box, const BitsLayout& layout,
                             const std::array<int32_t, kPackedDirections>& steps,
                             absl::FunctionRef<void(const Crossings&)> f) const {
  Placed at{{}, false, box.max - box.min, layout.stride, 0, steps.data()};
  bool beyond_margin = false;
  Vec3i low, high;  // tiles that meet the box
  for (size_t m = 0; m < 3; ++m) {
    beyond_margin |= block.min[m] - box.min[m] > margin_[m] || box.max[m] - block.max[m] > margin_[m];
    low[m] = std::max(box.min[m] >> kTileBits, first_tile_[m]);
    high[m] = (box.max[m] - 1) >> kTileBits;
  }
  Crossings batch;
  batch.nearer.Reserve(kBatch);
  batch.farther.Reserve(kBatch);
  const auto hand_out = [&] {
    if (batch.nearer.size() > 0) f(batch);
    batch.Clear();
  };
  for (Vec3i tile = low; tile[0] <= high[0]; ++tile[0]) {
    for (tile[1] = low[1]; tile[1] <= high[1]; ++tile[1]) {
      for (tile[2] = low[2]; tile[2] <= high[2]; ++tile[2]) {
        const uint64_t number = TileNumber(tile - first_tile_);
        const bool all = beyond_margin || block.Contains(tile * kTileSide);
        const Vec3i tile_min = tile * kTileSide;
        at.from_box = tile_min - box.min;
        at.all_inside =
            box.Contains(tile_min) && box.Contains(tile_min + Vec3i{kTileSide - 1, kTileSide - 1, kTileSide - 1});
        at.number = layout.NumberOf(tile_min);
        for (auto t = From(number); t != tiles_.end() && t->number == number; ++t) {
          (all ? t->lists->all : t->lists->border).ForEachBlock([&](std::span<const uint32_t> links) {
            if (batch.nearer.size() + links.size() > kBatch) hand_out();
            HWY_DYNAMIC_DISPATCH(Unpack)(at, links, batch);
          });
        }
      }
    }
  }
  hand_out();
}

}  // namespace latvox
#endif  // HWY_ONCE
