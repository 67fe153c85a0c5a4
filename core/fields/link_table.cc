#include "core/fields/link_table.h"

#include <algorithm>
#include <bit>

namespace latvox {
namespace {

// Sets a field of `count` numbers. They are aligned, because a vector of bytes allocates as for any type.
template <class T>
T* SetAll(std::vector<std::byte>& field, size_t count, T value) {
  field.resize(count * sizeof(T));
  T* const numbers = reinterpret_cast<T*>(field.data());
  std::fill_n(numbers, count, value);
  return numbers;
}

}  // namespace

void LinkTable::Begin(const FieldList& fields, size_t neighbors, const IndexBox& block, const SnappedMesh& mesh,
                      std::span<TileBricks> tiles) {
  mesh_ = &mesh;
  neighbors_ = neighbors;
  low_ = block.min;
  side_ = block.max[0] - block.min[0];
  side_bricks_ = side_ / kBrickSide;
  bricks_.assign(static_cast<size_t>(side_bricks_) * static_cast<size_t>(side_bricks_ * side_bricks_), kNone);
  places_.clear();
  columns_.clear();
  shares_.resize(tiles.size());
  for (TileBricks& tile : tiles) BeginTile(fields, mesh.base_ijk, tile);
}

void LinkTable::BeginTile(const FieldList& fields, const Vec3i& base_ijk, TileBricks& tile) {
  const size_t count = tile.voxels * neighbors_;
  const auto number = static_cast<uint32_t>(columns_.size());
  Columns columns{nullptr, nullptr, nullptr};
  tile.fields.resize(fields.size());
  for (size_t n = 0; n < fields.size(); ++n) {
    std::vector<std::byte>& field = tile.fields[n];
    switch (fields.view()[n]) {
      case Field::kLinks:
        columns.shares = SetAll(field, count, kNotCrossed);
        break;
      case Field::kLinkTriangles:
        columns.triangles = SetAll(field, count, kNoTriangle);
        break;
      case Field::kLinkCrossings:
        columns.crossings = SetAll(field, count, uint32_t{0});
        break;
      default:
        break;
    }
  }
  if (columns.triangles != nullptr && columns.shares == nullptr) {
    shares_[number].assign(count, kNotCrossed);
    columns.shares = shares_[number].data();
  }
  columns_.push_back(columns);
  uint32_t voxels = 0;
  for (const Brick& brick : tile.bricks) {
    const Vec3i at = brick.brick_ijk - Shifted(base_ijk + low_, kBrickBits);
    bricks_[NumberOf(at)] = static_cast<uint32_t>(places_.size());
    places_.resize(places_.size() + 1);
    Places& places = places_.back();
    places.mask = &brick.mask;
    places.tile = number;
    places.first = voxels;
    uint16_t rank = 0;
    for (size_t x = 0; x < brick.mask.size(); ++x) {
      for (uint64_t bits = brick.mask[x]; bits != 0; bits &= bits - 1) {
        places.ranks[x << 6 | static_cast<size_t>(std::countr_zero(bits))] = rank++;
      }
    }
    voxels += rank;
  }
}

// Decides between two crossings whose shares are equal as floats. Rounding keeps the order of all others.
bool LinkTable::ComesFirst(const Row& row, size_t place, const LinkCrossing& crossing) const {
  if (row.triangles == nullptr) return false;
  const uint32_t other = row.triangles[place];
  const LinkShare share = SharesAt(OrientedTriangle(mesh_->TriangleAt(other)), crossing.z).Along(crossing.q);
  const auto order = crossing.share <=> share;
  return order < 0 || (order == 0 && crossing.triangle < other);
}

size_t LinkTable::Bytes() const {
  size_t bytes = BytesOf(bricks_) + BytesOf(places_) + BytesOf(columns_) + BytesOf(shares_);
  for (const std::vector<float>& shares : shares_) bytes += BytesOf(shares);
  return bytes;
}

}  // namespace latvox
