// A set of crossed links, by voxels.
#ifndef LATVOX_CORE_THIN_CROSSED_LINKS_H_
#define LATVOX_CORE_THIN_CROSSED_LINKS_H_

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/bytes_of.h"
#include "core/base/vec.h"
#include "core/lattice/frame.h"
#include "core/tile/tile_bits.h"

namespace latvox {

// Stores each link at its nearer end: a word of bits for each voxel. However often a link is added, and however many
// meet, it takes 4 bytes for each voxel of a row of 32 that has any.
class CrossedLinks {
 public:
  // The bits of a voxel: bit n stands for the link to voxel - q, kForward + n for the link to voxel + q, with q the
  // n-th direction. The last bit is a mark, for Thin.
  static constexpr size_t kForward = 15;
  static constexpr uint32_t kLinks = (uint32_t{1} << 2 * kForward) - 1, kUnsure = uint32_t{1} << 31;
  static_assert(kMaxPairs <= kForward);

  // Makes it empty, for voxels of this layout.
  void Reset(const BitsLayout& layout) {
    for (const uint32_t row : touched_) rows_[row] = 0;
    touched_.clear();
    words_.reserve(kUsual);
    words_.assign(kRow, 0);
    count_ = all_ = 0;
    rows_.resize(layout.Words());
  }
  // The next direction.
  void AddDirection(const BitsLayout& layout, const Vec3i& q) {
    const uint32_t flip = static_cast<uint32_t>((q[0] & 1) << 2 | (q[1] & 1) << 1 | (q[2] & 1));
    steps_[count_] = {-layout.StepOf(q), flip};
    steps_[kForward + count_] = {layout.StepOf(q), flip};
    all_ |= uint32_t{1} << count_ | uint32_t{1} << (kForward + count_);
    ++count_;
  }

  // Returns the bits of the links along the directions in `which`, to voxel + q for those also in `forward`.
  static uint32_t BitsOf(uint32_t which, uint32_t forward) {
    return (which & ~forward) | (which & forward) << kForward;
  }
  // Returns the other end of the link that a bit of the voxel stands for.
  uint32_t EndOf(uint32_t voxel, size_t bit) const { return voxel + static_cast<uint32_t>(steps_[bit].number); }

  // Adds the link from a voxel to a neighbor.
  void AddBetween(uint32_t voxel, uint32_t other) {
    size_t n = 0;
    while (EndOf(voxel, n) != other && EndOf(voxel, kForward + n) != other) ++n;
    At(voxel) |= uint32_t{1} << (EndOf(voxel, n) == other ? n : kForward + n);
  }
  // Removes all marks.
  void ClearMarks() {
    for (uint32_t& word : words_) word &= kLinks;
  }

  // Whether all links of a voxel are in the set.
  bool IsFull(uint32_t voxel) const { return (Get(voxel) & all_) == all_; }

  size_t Bytes() const { return BytesOf(rows_) + BytesOf(words_) + BytesOf(touched_); }

  // Returns a voxel's bits.
  uint32_t Get(uint32_t voxel) const { return words_[rows_[voxel / kRow] * kRow + voxel % kRow]; }
  // Returns a voxel's bits, to be changed.
  uint32_t& At(uint32_t voxel) {
    uint32_t& row = rows_[voxel / kRow];
    if (row == 0) {
      row = static_cast<uint32_t>(words_.size() / kRow);
      words_.resize(words_.size() + kRow);
      touched_.push_back(voxel / kRow);
    }
    return words_[row * kRow + voxel % kRow];
  }

  // Returns the bits of links from voxels of a parity class to those of lower ones.
  uint32_t ToLowerClasses(uint32_t parity) const {
    uint32_t bits = 0;
    for (size_t bit = 0; bit < steps_.size(); ++bit) {
      if ((all_ >> bit & 1) != 0 && (parity ^ steps_[bit].flip) < parity) bits |= uint32_t{1} << bit;
    }
    return bits;
  }

  // Calls f(other) with the other ends of the links among these bits of a voxel, until it returns true. Returns whether
  // it did.
  template <class F>
  bool Any(uint32_t voxel, uint32_t bits, F&& f) const {
    for (bits &= kLinks; bits != 0; bits &= bits - 1) {
      if (f(EndOf(voxel, static_cast<size_t>(std::countr_zero(bits))))) return true;
    }
    return false;
  }
  // Calls f(other) with the other ends of these links of a voxel.
  template <class F>
  void ForEach(uint32_t voxel, uint32_t bits, F&& f) const {
    for (bits &= kLinks; bits != 0; bits &= bits - 1) f(EndOf(voxel, static_cast<size_t>(std::countr_zero(bits))));
  }

 private:
  static constexpr uint32_t kRow = 32;
  // In words: more than most blocks need. Unused memory costs nothing, but growing does.
  static constexpr size_t kUsual = size_t{1} << 18;
  struct Step {
    int32_t number;  // the difference of the other end's number
    uint32_t flip;   // the parity class of the other end is that of the voxel ^ flip
  };

  std::array<Step, 2 * kForward> steps_{};  // by bit
  uint32_t count_ = 0, all_ = 0;            // directions; all bits of links
  std::vector<uint32_t> rows_;              // of kRow numbers: the place of their words, or 0
  std::vector<uint32_t> words_;             // the first kRow are 0, for all other rows
  std::vector<uint32_t> touched_;           // rows
};

}  // namespace latvox

#endif  // LATVOX_CORE_THIN_CROSSED_LINKS_H_
