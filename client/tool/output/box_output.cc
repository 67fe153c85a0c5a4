#include "client/tool/output/box_output.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/tool/output/format_limit.h"

namespace latvox::client {
namespace {

constexpr double kRounding = 1e-12;  // relative, of the vectors of a scaled lattice

// Joins runs of equal cells, and writes them as (value, length) with lengths up to 255.
class RunWriter {
 public:
  explicit RunWriter(AtomicFile& file) : file_(file) {}

  void Add(bool value, uint64_t length) {
    if (length == 0) return;
    if (value != value_) Write();
    value_ = value;
    length_ += length;
  }

  // Returns the first error.
  absl::Status Finish() {
    Write();
    Flush();
    return status_;
  }

 private:
  void Write() {
    constexpr uint64_t kMost = 255;
    for (; length_ > 0; length_ -= std::min(length_, kMost)) {
      bytes_.push_back(value_ ? 1 : 0);
      bytes_.push_back(static_cast<char>(std::min(length_, kMost)));
      if (bytes_.size() >= size_t{1} << 16) Flush();
    }
  }
  void Flush() {
    if (status_.ok()) status_ = file_.Append(bytes_);
    bytes_.clear();
  }

  AtomicFile& file_;
  bool value_ = false;
  uint64_t length_ = 0;
  std::string bytes_;
  absl::Status status_;
};

// Returns the first bit with the value, at or behind `from`, or `end`.
size_t FindBit(const uint64_t* words, size_t from, size_t end, bool value) {
  while (from < end) {
    const uint64_t word = (value ? words[from / 64] : ~words[from / 64]) >> from % 64;
    if (word != 0) return std::min(end, from + static_cast<size_t>(std::countr_zero(word)));
    from = (from / 64 + 1) * 64;
  }
  return end;
}

// Moves bit y << 3 | z to z << 3 | y.
uint64_t Transposed(uint64_t bits) {
  for (const auto& [shift, mask] : {std::pair(7, 0x00AA00AA00AA00AAULL), std::pair(14, 0x0000CCCC0000CCCCULL),
                                    std::pair(28, 0x00000000F0F0F0F0ULL)}) {
    const uint64_t swapped = (bits ^ bits >> shift) & mask;
    bits ^= swapped ^ swapped << shift;
  }
  return bits;
}

// Collects all bricks, then writes cells over x, then z, then y, which changes fastest. One slice of constant x is in
// memory, a bit for each cell.
class BinvoxOutput final : public Output {
 public:
  BinvoxOutput(std::unique_ptr<AtomicFile> file, const BoxShape& shape) : file_(std::move(file)), shape_(shape) {}

  absl::Status Begin(const Accepted& accepted) override {
    if (!IsCubic(accepted.grid.basis)) {
      return NoSuchCells(file_->target(), kCubesOnly);
    }
    grid_ = accepted.grid;
    return absl::OkStatus();
  }

  absl::Status Add(const BrickBatch& batch) override {
    for (const Brick& brick : batch.bricks) {
      box_.Add(brick);
      bricks_.push_back(brick);
    }
    return FindBox();  // here, so that a box beyond the format's ends the job
  }

  absl::Status Finish(const Summary&) override {
    if (auto status = FindBox(); !status.ok()) return status;
    if (auto status = Write(); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  absl::Status FindBox() {
    const std::optional<IndexBox>& voxels = box_.box();
    if (!voxels && !shape_.dims) return absl::OkStatus();
    const auto shaped = ShapedBox(voxels ? *voxels : IndexBox{}, shape_, file_->target());
    if (!shaped.ok()) return shaped.status();
    low_ = shaped->min;
    int64_t longest = 0;
    for (size_t m = 0; m < 3; ++m) {
      const int64_t side = int64_t{shaped->max[m]} - low_[m];
      if (side > kMostSide) {
        const std::string limit = absl::StrCat(kMostSide);
        return TooLarge(file_->target(),
                        absl::StrCat(side, " voxels along ", std::string(1, "xyz"[m]), " exceed the format's ", limit),
                        absl::StrCat(side), limit);
      }
      longest = std::max(longest, side);
    }
    side_ = static_cast<int32_t>(longest);
    return absl::OkStatus();
  }

  absl::Status Write() {
    const double size = grid_.basis.a[0];
    Vec3d corner = grid_.ToWorld(low_);
    for (double& x : corner) x -= size / 2;
    const std::string header =
        absl::StrFormat("#binvox 1\ndim %d %d %d\ntranslate %.17g %.17g %.17g\nscale %.17g\ndata\n", side_, side_,
                        side_, corner[0], corner[1], corner[2], size * side_);
    if (auto status = file_->Append(header); !status.ok()) return status;
    const auto is_lower = [](const Brick& a, const Brick& b) { return a.brick_ijk[0] < b.brick_ijk[0]; };
    std::sort(bricks_.begin(), bricks_.end(), is_lower);
    // Rows along y begin at a brick, so that each byte is a row of a brick.
    const auto cells = static_cast<size_t>(side_), first = static_cast<size_t>(low_[1] & 7);
    const size_t row_words = (first + cells) / 64 + 1;
    std::vector<uint64_t> slice(cells * row_words);
    RunWriter runs(*file_);
    auto begin = bricks_.begin(), end = begin;
    for (int32_t i = low_[0]; i < low_[0] + side_; ++i) {
      while (begin != bricks_.end() && begin->brick_ijk[0] < i >> 3) ++begin;
      for (end = std::max(begin, end); end != bricks_.end() && end->brick_ijk[0] == i >> 3;) ++end;
      if (begin == end) {
        runs.Add(false, cells * cells);
        continue;
      }
      std::fill(slice.begin(), slice.end(), 0);
      FillSlice({begin, end}, static_cast<size_t>(i & 7), row_words, slice);
      for (size_t z = 0; z < cells; ++z) AddRow(&slice[z * row_words], first, first + cells, runs);
    }
    return runs.Finish();
  }

  void FillSlice(std::span<const Brick> layer, size_t x, size_t row_words, std::vector<uint64_t>& slice) const {
    auto* const bytes = reinterpret_cast<uint8_t*>(slice.data());
    for (const Brick& brick : layer) {
      const uint64_t rows = Transposed(brick.mask[x]);
      const auto column = static_cast<size_t>(brick.brick_ijk[1] - (low_[1] >> 3));
      for (int32_t z = 0; z < 8; ++z) {
        const auto row = static_cast<uint8_t>(rows >> 8 * z);
        if (row == 0) continue;  // perhaps outside the box
        const auto k = static_cast<size_t>(brick.brick_ijk[2] * 8 + z - low_[2]);
        bytes[k * row_words * sizeof(uint64_t) + column] = row;
      }
    }
  }

  static void AddRow(const uint64_t* words, size_t at, size_t end, RunWriter& runs) {
    while (at < end) {
      const size_t one = FindBit(words, at, end, true), zero = FindBit(words, one, end, false);
      runs.Add(false, one - at);
      runs.Add(true, zero - one);
      at = zero;
    }
  }

  static constexpr int64_t kMostSide = 4096;

  const std::unique_ptr<AtomicFile> file_;
  const BoxShape shape_;
  GridTransform grid_;
  VoxelBox box_;
  std::vector<Brick> bricks_;
  Vec3i low_{};
  int32_t side_ = 1;
};

}  // namespace

bool IsAlongAxes(const Basis& basis) {
  const Vec3d steps[] = {basis.a, basis.b, basis.c};
  for (size_t n = 0; n < 3; ++n) {
    for (size_t m = 0; m < 3; ++m) {
      if (n == m ? !(steps[n][n] > 0) : !(std::abs(steps[n][m]) <= kRounding * steps[n][n])) return false;
    }
  }
  return true;
}

bool IsCubic(const Basis& basis) {
  const double side = basis.a[0];
  const auto is_side = [side](double other) { return std::abs(other - side) <= kRounding * side; };
  return IsAlongAxes(basis) && is_side(basis.b[1]) && is_side(basis.c[2]);
}

std::unique_ptr<Output> NewBinvoxOutput(std::unique_ptr<AtomicFile> file, const BoxShape& shape) {
  return std::make_unique<BinvoxOutput>(std::move(file), shape);
}

}  // namespace latvox::client
