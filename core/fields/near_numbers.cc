#include "core/fields/near_numbers.h"

#include <algorithm>
#include <iterator>

namespace latvox {

void NearNumbers::Begin(const SnappedMesh& mesh, const FieldPlan& plan, std::span<const uint32_t> triangles,
                        const Vec3i& low, StopSignal stop) {
  constexpr size_t kPiece = 4096;  // triangles between two looks at the stop signal
  const int bits = kSubvoxelBits + cell_bits_;
  const Vec3i reach = *plan.near_reach, origin = low * kLatticeUnit;
  numbers_ = plan.of_vertices.data();
  count_ = plan.of_mesh.size();
  rows_.fill({});
  kinds_.clear();
  last_kind_ = kMixed;
  of_row_ = {-1, -1};
  all_.clear();
  all_.reserve(triangles.size());
  for (size_t n = 0; n < triangles.size(); ++n) {
    if (n % kPiece == 0 && stop.Stopped()) return;
    const auto& [a, b, c] = mesh.triangles[triangles[n]];
    const Vec3i u = mesh.vertices_lat[a] - origin, v = mesh.vertices_lat[b] - origin, w = mesh.vertices_lat[c] - origin;
    Vec3i first, last;
    for (size_t m = 0; m < 3; ++m) {
      const int32_t least = std::min(std::min(u[m], v[m]), w[m]), most = std::max(std::max(u[m], v[m]), w[m]);
      first[m] = std::max((least - reach[m] + kLatticeUnit - 1) >> bits, 0);
      last[m] = std::min((most + reach[m]) >> bits, kSide - 1);
    }
    if (first[0] > last[0] || first[1] > last[1] || first[2] > last[2]) continue;
    uint32_t slabs = 0;
    for (int m = 0; m < 3; ++m) {
      const auto axis = static_cast<size_t>(m);
      slabs |= ((2U << last[axis]) - (1U << first[axis])) << (m * kSide);
    }
    all_.push_back({slabs, triangles[n]});
    const uint64_t cells = (~uint64_t{0} >> 8 * (kSide - 1 - last[2] + first[2])) << 8 * first[2];
    const uint64_t kind = cells & KindOf(mesh.triangles[triangles[n]]) * uint64_t{0x0101010101010101};
    const bool is_mixed = last_kind_ == kMixed;
    for (int32_t i = first[0]; i <= last[0]; ++i) {
      for (int32_t j = first[1]; j <= last[1]; ++j) {
        Row& row = rows_[RowOf(i, j)];
        row.any |= kind;
        row.all &= is_mixed ? ~cells : kind | ~cells;
      }
    }
  }
}

// Neighbors in the list of triangles mostly are of one kind.
uint8_t NearNumbers::KindOf(const std::array<uint32_t, 3>& corners) {
  const uint32_t a = corners[0], b = corners[1], c = corners[2];
  if (!AreEqual(a, b) || !AreEqual(a, c)) return last_kind_ = kMixed;
  if (last_kind_ != kMixed && AreEqual(a, kinds_[last_kind_ - size_t{1}])) return last_kind_;
  const auto known = std::ranges::find_if(kinds_, [&](uint32_t vertex) { return AreEqual(a, vertex); });
  if (known == kinds_.end()) {
    if (kinds_.size() == kMostKinds) return last_kind_ = kMixed;
    kinds_.push_back(a);
    return last_kind_ = static_cast<uint8_t>(kinds_.size());
  }
  return last_kind_ = static_cast<uint8_t>(known - kinds_.begin() + 1);
}

void NearNumbers::Keep(const std::vector<Placed>& from, int slab, std::vector<Placed>& kept) {
  kept.clear();
  kept.reserve(from.size());
  std::ranges::copy_if(from, std::back_inserter(kept),
                       [slab](const Placed& placed) { return (placed.slabs >> slab & 1) != 0; });
}

std::span<const uint32_t> NearNumbers::TrianglesNear(const Vec3i& cell) {
  if (cell[0] != of_row_[0]) {
    Keep(all_, cell[0], slab_);
    of_row_ = {cell[0], -1};
  }
  if (cell[1] != of_row_[1]) {
    Keep(slab_, kSide + cell[1], row_);
    of_row_[1] = cell[1];
  }
  near_.clear();
  near_.reserve(row_.size());
  for (const Placed& placed : row_) {
    if ((placed.slabs >> (2 * kSide + cell[2]) & 1) != 0) near_.push_back(placed.triangle);
  }
  return near_;
}

}  // namespace latvox
