#include "client/tool/output/dense_box.h"

#include <algorithm>
#include <bit>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/tool/output/format_limit.h"

namespace latvox::client {

absl::Status DenseBox::SetBox(const std::optional<IndexBox>& box, uint64_t element_bytes, const std::string& target) {
  if (!box) return absl::OkStatus();
  constexpr uint64_t kMost = uint64_t{1} << 32;
  low_ = box->min;
  for (size_t m = 0; m < 3; ++m) shape_[m] = static_cast<uint64_t>(int64_t{box->max[m]} - low_[m]);
  // Multiplies step by step, so that nothing overflows.
  uint64_t bytes = element_bytes;
  for (const uint64_t side : shape_) {
    bytes *= side;
    if (bytes <= kMost) continue;
    const std::string sides = absl::StrJoin(shape_, " x "), limit = absl::StrCat(kMost, " bytes");
    return TooLarge(target, absl::StrCat("a dense array of ", sides, " elements exceeds ", limit), sides, limit,
                    "request less with --region, or a .npy or .h5, which hold voxels alone");
  }
  return absl::OkStatus();
}

void DenseBox::Add(const BrickBatch& batch) {
  for (const Brick& brick : batch.bricks) {
    bricks_.push_back({brick, voxels_});
    for (const uint64_t word : brick.mask) voxels_ += static_cast<uint64_t>(std::popcount(word));
  }
}

void DenseBox::Sort() {
  std::sort(bricks_.begin(), bricks_.end(), [this](const Placed& a, const Placed& b) {
    const Vec3i &v = a.brick.brick_ijk, &w = b.brick.brick_ijk;
    return std::tie(v[outer_], v[1], v[inner_]) < std::tie(w[outer_], w[1], w[inner_]);
  });
}

void DenseBox::EnterLayer(int32_t layer) {
  if (layer_ == layer) return;
  layer_ = layer;
  const int64_t first = low_[1] >> 3, last = (low_[1] + static_cast<int64_t>(shape_[1]) - 1) >> 3;
  columns_.clear();
  const auto is_before = [this](const Placed& a, const auto& place) {
    return std::pair(a.brick.brick_ijk[outer_], int64_t{a.brick.brick_ijk[1]}) < place;
  };
  auto brick = std::lower_bound(bricks_.begin(), bricks_.end(), std::pair(layer, first), is_before);
  for (int64_t j = first; j <= last + 1; ++j) {
    while (brick != bricks_.end() && brick->brick.brick_ijk[outer_] == layer && brick->brick.brick_ijk[1] < j) ++brick;
    columns_.push_back(static_cast<size_t>(brick - bricks_.begin()));
  }
}

void DenseBox::ForEachAlongK(const Placed& placed, size_t x, size_t y,
                             absl::FunctionRef<void(int64_t, uint64_t)> visit) const {
  const auto& mask = placed.brick.mask;
  const size_t shift = 8 * y;
  uint64_t n = placed.first;
  for (size_t before = 0; before < x; ++before) n += static_cast<uint64_t>(std::popcount(mask[before]));
  n += static_cast<uint64_t>(std::popcount(mask[x] & ((uint64_t{1} << shift) - 1)));
  for (uint64_t bits = mask[x] >> shift & 0xFF; bits != 0; bits &= bits - 1, ++n) {
    visit(int64_t{placed.brick.brick_ijk[2]} * 8 + std::countr_zero(bits), n);
  }
}

void DenseBox::ForEachAlongI(const Placed& placed, size_t y, size_t z,
                             absl::FunctionRef<void(int64_t, uint64_t)> visit) const {
  const uint64_t bit = uint64_t{1} << (8 * y + z);
  uint64_t n = placed.first;
  for (size_t x = 0; x < 8; ++x) {
    const uint64_t word = placed.brick.mask[x];
    if ((word & bit) != 0) {
      visit(int64_t{placed.brick.brick_ijk[0]} * 8 + static_cast<int64_t>(x),
            n + static_cast<uint64_t>(std::popcount(word & (bit - 1))));
    }
    n += static_cast<uint64_t>(std::popcount(word));
  }
}

void DenseBox::ForEachInRow(uint64_t row, absl::FunctionRef<void(uint64_t at, uint64_t n)> visit) {
  const auto outer = static_cast<int32_t>(low_[outer_] + static_cast<int64_t>(row / shape_[1]));
  const auto j = static_cast<int32_t>(low_[1] + static_cast<int64_t>(row % shape_[1]));
  const auto in_brick = static_cast<size_t>(outer & 7), y = static_cast<size_t>(j & 7);
  const auto put = [&](int64_t coordinate, uint64_t n) {
    const int64_t at = coordinate - low_[inner_];
    if (at >= 0 && at < static_cast<int64_t>(row_elements())) visit(static_cast<uint64_t>(at), n);
  };
  EnterLayer(outer >> 3);
  const auto column = static_cast<size_t>((j >> 3) - (low_[1] >> 3));
  for (size_t b = columns_[column]; b < columns_[column + 1]; ++b) {
    outer_ == 0 ? ForEachAlongK(bricks_[b], in_brick, y, put) : ForEachAlongI(bricks_[b], y, in_brick, put);
  }
}

DenseRows::DenseRows(DenseBox& box, std::string empty, std::function<void(uint64_t n, char* element)> put)
    : box_(box), empty_(std::move(empty)), put_(std::move(put)) {
  empty_row_.reserve(box_.row_elements() * empty_.size());
  for (uint64_t at = 0; at < box_.row_elements(); ++at) empty_row_ += empty_;
}

void DenseRows::Next(std::string& chunk) {
  constexpr size_t kChunk = size_t{1} << 20;
  chunk.clear();
  for (; row_ < box_.rows() && chunk.size() < kChunk; ++row_) {
    const size_t begin = chunk.size();
    chunk += empty_row_;
    box_.ForEachInRow(row_, [&](uint64_t at, uint64_t n) { put_(n, &chunk[begin + at * empty_.size()]); });
  }
}

}  // namespace latvox::client
