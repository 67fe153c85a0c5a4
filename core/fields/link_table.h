// The fields of links of a block's voxels, while its crossings come in any order.
#ifndef LATVOX_CORE_FIELDS_LINK_TABLE_H_
#define LATVOX_CORE_FIELDS_LINK_TABLE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/bytes_of.h"
#include "core/base/uninitialized.h"
#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/fields/link_share.h"
#include "core/request/fields.h"
#include "core/snap/snap.h"

namespace latvox {

// A triangle that crosses the link z -> z + q.
struct LinkCrossing {
  Vec3i z, q;  // z is local
  uint32_t triangle;
  LinkShare share;
};

// The values stand in TileBricks::fields from the beginning. So the memory is bounded by that of the result, however
// many triangles cross a link. Each thread has its own, and reuses it from block to block.
class LinkTable {
 public:
  // One voxel's values: for each neighbor, in the order of core/fields/link_order.h.
  struct Row {
    float* shares = nullptr;        // null: the voxel is not in the set, or only numbers of crossings are wanted
    uint32_t* triangles = nullptr;  // null unless wanted
    uint32_t* crossings = nullptr;  // null unless wanted
    bool empty() const { return shares == nullptr && crossings == nullptr; }
  };

  // Begins with a block, and sets the fields of links in its tiles as for voxels without a crossed link.
  //   fields   of the request; those of links are at these places of TileBricks::fields
  //   block    local voxels: a cube of tiles
  //   tiles    global; must live, unchanged, while this is used
  void Begin(const FieldList& fields, size_t neighbors, const IndexBox& block, const SnappedMesh& mesh,
             std::span<TileBricks> tiles);

  // The row of a voxel (local).
  Row RowOf(const Vec3i& ijk) const {
    const Vec3i at = ijk - low_;
    for (size_t m = 0; m < 3; ++m) {
      if (at[m] < 0 || at[m] >= side_) return {};
    }
    const uint32_t number = bricks_[NumberOf(Shifted(at, kBrickBits))];
    if (number == kNone) return {};
    const Places& brick = places_[number];
    const auto x = static_cast<size_t>(at[0] & (kBrickSide - 1));
    const auto yz = static_cast<size_t>((at[1] & (kBrickSide - 1)) << kBrickBits | (at[2] & (kBrickSide - 1)));
    if (((*brick.mask)[x] >> yz & 1) == 0) return {};
    const Columns& columns = columns_[brick.tile];
    const size_t first = (brick.first + brick.ranks[x << 6 | yz]) * neighbors_;
    return {columns.shares == nullptr ? nullptr : columns.shares + first,
            columns.triangles == nullptr ? nullptr : columns.triangles + first,
            columns.crossings == nullptr ? nullptr : columns.crossings + first};
  }

  // Adds a crossing at this place of a row. The first along the link wins. The smallest triangle wins a tie.
  void Add(const Row& row, size_t place, const LinkCrossing& crossing) const {
    if (row.crossings != nullptr) ++row.crossings[place];
    if (row.shares == nullptr) return;
    const float share = crossing.share.ToFloat(), best = row.shares[place];
    if (share > best || (share == best && !ComesFirst(row, place, crossing))) return;
    row.shares[place] = share;
    if (row.triangles != nullptr) row.triangles[place] = crossing.triangle;
  }

  // Bytes of memory.
  size_t Bytes() const;

 private:
  static constexpr uint32_t kNone = UINT32_MAX;

  // The values of a tile.
  struct Columns {
    float* shares;
    uint32_t *triangles, *crossings;
  };
  // A brick's voxels among those of its tile.
  struct Places {
    const BrickMask* mask;
    uint32_t tile;                    // in columns_
    uint32_t first;                   // its first voxel
    std::array<uint16_t, 512> ranks;  // of its voxels; others are meaningless
  };

  size_t NumberOf(const Vec3i& brick) const {
    return static_cast<size_t>((brick[0] * side_bricks_ + brick[1]) * side_bricks_ + brick[2]);
  }
  void BeginTile(const FieldList& fields, const Vec3i& base_ijk, TileBricks& tile);
  bool ComesFirst(const Row& row, size_t place, const LinkCrossing& crossing) const;

  const SnappedMesh* mesh_ = nullptr;
  size_t neighbors_ = 0;
  Vec3i low_{};  // of the block
  int32_t side_ = 0, side_bricks_ = 0;
  std::vector<uint32_t> bricks_;  // the number in places_ of each brick of the block, or kNone
  UninitializedVector<Places> places_;
  std::vector<Columns> columns_;
  std::vector<std::vector<float>> shares_;  // of tiles whose fields lack them, to compare triangles by
};

}  // namespace latvox

#endif  // LATVOX_CORE_FIELDS_LINK_TABLE_H_
