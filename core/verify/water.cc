#include "core/verify/water.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "core/verify/bcc_indexing.h"

namespace latvox {
namespace {

constexpr Vec3i kCorner{-kVolumeMargin, -kVolumeMargin, -kVolumeMargin};
constexpr int kWordBits = 64;
static_assert(kVolumeMargin % 2 == 0, "bit z of a word is point z mod 2");
static_assert(kMaxDirection < kWordBits, "a step moves a bit by less than a word");

Vec3i ToLattice(Numbering numbering, const Vec3i& number) {
  return numbering == Numbering::kBcc ? BccToLattice(number) : number;
}

Vec3i ToNumber(Numbering numbering, const Vec3i& ijk) { return numbering == Numbering::kBcc ? LatticeToBcc(ijk) : ijk; }

// The rows of a padded volume as bits, while the water flows. Rows take turns in drawing water from the rows around
// them.
class Basin {
 public:
  using Bits = std::vector<uint64_t>;
  Basin(Numbering numbering, const Vec3i& padded, size_t row_words, const std::vector<Frame>& frames)
      : padded_(padded), row_words_(row_words), reached_(row_words), drawn_(row_words) {
    for (const Frame& frame : frames) {
      AddStep(numbering, frame.q);
      AddStep(numbering, -frame.q);
    }
  }

  // Lets the water of `water` flow to all points of `open` that it can reach. It sweeps there and back; two sweeps are
  // enough unless the water must enter a bay backwards. Precondition: water is a part of open, in row 0.
  void Fill(const Bits& open, Bits& water) {
    const auto rows = static_cast<int32_t>(open.size() / row_words_);
    stale_.assign(static_cast<size_t>(rows), false);
    stale_[0] = true;
    MarkAround(0, 0);
    for (int32_t first = 0, step = 1; std::find(stale_.begin(), stale_.end(), true) != stale_.end(); step = -step) {
      for (int32_t row = first; 0 <= row && row < rows; row += step) {
        if (!stale_[static_cast<size_t>(row)]) continue;
        stale_[static_cast<size_t>(row)] = false;
        Draw(open, water, row);
      }
      first = step > 0 ? rows - 1 : 0;
    }
  }

 private:
  // Water at (x, y, z) reaches (x + dx, y + dy, z + dz), if z is one of the bits `from` of its word.
  struct Shift {
    int32_t dz;
    uint64_t from;
    bool operator<(const Shift& other) const { return std::tie(dz, from) < std::tie(other.dz, other.from); }
  };
  using Offset = std::pair<int32_t, int32_t>;  // dx, dy of a row

  // In BCC's numbering, a step depends on whether z is odd.
  void AddStep(Numbering numbering, const Vec3i& q) {
    constexpr uint64_t kEven = 0x5555555555555555;
    std::array<Vec3i, 2> steps;
    for (int32_t odd : {0, 1}) {
      const Vec3i from{0, 0, odd};
      steps[static_cast<size_t>(odd)] = ToNumber(numbering, ToLattice(numbering, from) + q) - from;
    }
    const auto add = [this](const Vec3i& step, uint64_t from) {
      draws_[{step[2], from}].push_back({step[0], step[1]});
      offsets_.insert({step[0], step[1]});
    };
    if (steps[0] != steps[1]) {
      add(steps[0], kEven);
      add(steps[1], ~kEven);
    } else if (steps[0][0] == 0 && steps[0][1] == 0) {
      strides_.insert(std::abs(steps[0][2]));
    } else {
      add(steps[0], ~uint64_t{0});
    }
  }

  // The number of row (x, y), or nullopt outside of the volume.
  std::optional<size_t> RowAt(int32_t x, int32_t y) const {
    if (x < 0 || x >= padded_[0] || y < 0 || y >= padded_[1]) return std::nullopt;
    return static_cast<size_t>(x * padded_[1] + y);
  }

  // Marks the rows that may draw from row (x, y).
  void MarkAround(int32_t x, int32_t y) {
    for (const auto& [dx, dy] : offsets_) {
      if (const auto row = RowAt(x + dx, y + dy)) stale_[*row] = true;
    }
  }

  void Draw(const Bits& open, Bits& water, int32_t row) {
    const int32_t x = row / padded_[1], y = row % padded_[1];
    const uint64_t* const open_row = open.data() + static_cast<size_t>(row) * row_words_;
    uint64_t* const water_row = water.data() + static_cast<size_t>(row) * row_words_;
    if (std::equal(open_row, open_row + row_words_, water_row)) return;  // full
    std::copy_n(water_row, row_words_, reached_.begin());
    for (const auto& [shift, offsets] : draws_) {
      std::fill(drawn_.begin(), drawn_.end(), 0);
      for (const auto& [dx, dy] : offsets) {
        const auto source = RowAt(x - dx, y - dy);
        if (!source) continue;
        const uint64_t* const source_row = water.data() + *source * row_words_;
        for (size_t w = 0; w < row_words_; ++w) drawn_[w] |= source_row[w];
      }
      Pour(shift, open_row);
    }
    for (const int32_t stride : strides_) Spread(stride, open_row);
    if (std::equal(reached_.begin(), reached_.end(), water_row)) return;
    std::copy(reached_.begin(), reached_.end(), water_row);
    MarkAround(x, y);
  }

  // Adds `drawn_`, moved, to `reached_`.
  void Pour(const Shift& shift, const uint64_t* open_row) {
    for (uint64_t& word : drawn_) word &= shift.from;
    const int up = std::max(shift.dz, 0), down = std::max(-shift.dz, 0);
    for (size_t w = 0; w < row_words_; ++w) {
      uint64_t word = drawn_[w] << up >> down;
      if (up > 0 && w > 0) word |= drawn_[w - 1] >> (kWordBits - up);
      if (down > 0 && w + 1 < row_words_) word |= drawn_[w + 1] << (kWordBits - down);
      reached_[w] |= word & open_row[w];
    }
  }

  // Spreads `reached_` along its row by steps of `stride`, up and down: within a word in doubling steps.
  void Spread(int32_t stride, const uint64_t* open_row) {
    uint64_t carry = 0;
    for (size_t w = 0; w < row_words_; ++w) {
      uint64_t way = open_row[w], water = reached_[w] | (carry & way);
      for (int step = stride; step < kWordBits; step *= 2) {
        water |= water << step & way;
        way &= way << step;
      }
      reached_[w] = water;
      carry = water >> (kWordBits - stride);
    }
    carry = 0;
    for (size_t w = row_words_; w-- > 0;) {
      uint64_t way = open_row[w], water = reached_[w] | (carry & way);
      for (int step = stride; step < kWordBits; step *= 2) {
        water |= water >> step & way;
        way &= way >> step;
      }
      reached_[w] = water;
      carry = water << (kWordBits - stride);
    }
  }

  const Vec3i padded_;
  const size_t row_words_;
  std::map<Shift, std::vector<Offset>> draws_;  // steps from other rows, those with one shift together
  std::set<Offset> offsets_;                    // of all draws_
  std::set<int32_t> strides_;                   // steps within a row
  std::vector<bool> stale_;                     // rows to which water may flow
  Bits reached_, drawn_;                        // of the row at hand
};

uint64_t Count(const std::vector<uint64_t>& bits) {
  uint64_t count = 0;
  for (uint64_t word : bits) count += static_cast<uint64_t>(std::popcount(word));
  return count;
}

}  // namespace

uint64_t Volume::points() const {
  return static_cast<uint64_t>(size[0]) * static_cast<uint64_t>(size[1]) * static_cast<uint64_t>(size[2]);
}

std::optional<Flood::Place> Flood::PlaceOf(const Vec3i& ijk) const {
  const Vec3i number = ToNumber(volume_.numbering, ijk) - kCorner;
  for (size_t m = 0; m < 3; ++m) {
    if (number[m] < 0 || number[m] >= padded_[m]) return std::nullopt;
  }
  const size_t row = static_cast<size_t>(number[0]) * static_cast<size_t>(padded_[1]) + static_cast<size_t>(number[1]);
  const auto z = static_cast<size_t>(number[2]);
  return Place{row * row_words_ + z / kWordBits, uint64_t{1} << z % kWordBits};
}

std::optional<Label> Flood::At(const Vec3i& ijk) const {
  const auto place = PlaceOf(ijk);
  if (!place) return std::nullopt;
  if (surface_bits_[place->word] & place->bit) return Label::kSurface;
  return water_bits_[place->word] & place->bit ? Label::kWater : Label::kInside;
}

double Flood::DisplacedVolume() const { return static_cast<double>(inside_) / static_cast<double>(volume_.points()); }

Flood::Flood(const Volume& volume, const VoxelSet& surface, const std::vector<Frame>& frames)
    : volume_(volume),
      padded_(volume.size - kCorner - kCorner),
      row_words_(static_cast<size_t>(padded_[2] + kWordBits - 1) / kWordBits) {
  const size_t rows = static_cast<size_t>(padded_[0]) * static_cast<size_t>(padded_[1]);
  surface_bits_.assign(rows * row_words_, 0);
  water_bits_.assign(rows * row_words_, 0);
  for (const Brick& brick : surface.Bricks()) {
    for (int32_t n = 0; n < 512; ++n) {
      if (!(brick.mask[static_cast<size_t>(n >> 6)] >> (n & 63) & 1)) continue;
      const auto place = PlaceOf(brick.brick_ijk * kBrickSide + Vec3i{n >> 6, n >> 3 & 7, n & 7});
      if (place) surface_bits_[place->word] |= place->bit;
    }
  }

  std::vector<uint64_t> open(surface_bits_.size());
  const int last_bits = (padded_[2] - 1) % kWordBits + 1;
  for (size_t w = 0; w < open.size(); ++w) {
    const bool is_last = w % row_words_ == row_words_ - 1;
    open[w] = ~surface_bits_[w] & (is_last ? ~uint64_t{0} >> (kWordBits - last_bits) : ~uint64_t{0});
  }
  water_bits_[0] = open[0] & 1;  // the low corner
  Basin(volume_.numbering, padded_, row_words_, frames).Fill(open, water_bits_);

  surface_ = Count(surface_bits_);
  water_ = Count(water_bits_);
  inside_ = rows * static_cast<size_t>(padded_[2]) - surface_ - water_;
}

}  // namespace latvox
