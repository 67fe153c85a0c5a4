#include "client/grid/part_tree.h"

#include <stdexcept>

namespace latvox::client {
namespace {

[[noreturn]] void Fail() { throw std::runtime_error("is damaged: its nodes are not as latvox wrote them"); }

class VdbTree final : public PartTree {
 public:
  VdbTree(std::istream& in, uint64_t begin, uint64_t end, uint64_t leaves)
      : PartTree(end - begin), in_(in), begin_(begin), end_(end), leaves_(leaves) {}

  uint64_t read() const override { return static_cast<uint64_t>(in_.tellg()) - begin_; }

 private:
  template <class T>
  T Get() {
    T value{};
    in_.read(reinterpret_cast<char*>(&value), sizeof(value));
    return value;
  }

  void ReadRoot() override {
    in_.seekg(static_cast<std::streamoff>(begin_));
    Get<int32_t>();  // buffers
    Get<char>();     // background
    const auto tiles = Get<uint32_t>();
    uppers_ = Get<uint32_t>();
    if (tiles > size() / sizeof(Vec3i)) Fail();
    tiles_.clear();
    for (uint32_t n = 0; n < tiles; ++n) {
      tiles_.push_back(Get<Vec3i>());
      if (Get<char>() != 1 || Get<char>() != 1) Fail();  // value, active
    }
    next_tile_ = 0;
    read_ = 0;
    corner_.reset();
  }

  bool ReadUpper(Vec3i& corner, UpperMask& children, UpperMask& tiles) override {
    if (!corner_ && uppers_ > 0) {
      corner_ = Get<Vec3i>();
      --uppers_;
    }
    if (next_tile_ < tiles_.size() && (!corner_ || tiles_[next_tile_] < *corner_)) {
      corner = tiles_[next_tile_++];
      children = {};
      tiles.Fill();
      return true;
    }
    if (!corner_) {
      if (static_cast<uint64_t>(in_.tellg()) != end_ || read_ != leaves_) Fail();
      return false;
    }
    corner = *corner_;
    corner_.reset();
    ReadNode(children, tiles);
    return true;
  }

  void ReadLower(const TreePlace&, LowerMask& children, LowerMask& tiles) override { ReadNode(children, tiles); }

  void ReadLeaf(const TreePlace&, BrickMask& mask) override {
    in_.read(reinterpret_cast<char*>(mask.data()), sizeof(mask));
    ++read_;
  }

  template <class Mask>
  void ReadNode(Mask& children, Mask& tiles) {
    in_.read(children.data(), Mask::kBytes);
    in_.read(tiles.data(), Mask::kBytes);
    if (Get<char>() != 0) Fail();
    const auto length = Get<int64_t>();  // negative: not compressed
    const uint64_t values = length < 0 ? ~static_cast<uint64_t>(length) + 1 : static_cast<uint64_t>(length);
    if (values > size()) Fail();
    in_.ignore(static_cast<std::streamsize>(values));
  }

  std::istream& in_;
  const uint64_t begin_, end_, leaves_;
  std::vector<Vec3i> tiles_;  // of the root, by low corner
  size_t next_tile_ = 0;
  uint32_t uppers_ = 0;          // that are left in the file
  std::optional<Vec3i> corner_;  // of the next upper node, if it was read
  uint64_t read_ = 0;            // leaves
};

}  // namespace

void PartTree::Rewind() {
  next_ = {{}, kLowersOfUpper, kBricksOfLower};
  ReadRoot();
}

bool PartTree::Next(Brick& brick) {
  for (;;) {
    for (; next_.brick < kBricksOfLower; ++next_.brick) {
      const bool is_leaf = leaves_.Has(next_.brick);
      if (!is_leaf && !tiles_.Has(next_.brick)) continue;
      const TreePlace place{next_.upper, next_.lower - 1, next_.brick};
      brick = {BrickAt(place), kFullBrick};
      if (is_leaf) ReadLeaf(place, brick.mask);
      ++next_.brick;
      return true;
    }
    if (!NextLower()) return false;
  }
}

// Reads the next lower node; false at the end.
bool PartTree::NextLower() {
  for (;;) {
    while (next_.lower < kLowersOfUpper) {
      const uint32_t lower = next_.lower++;
      const bool is_child = lowers_.Has(lower);
      if (!is_child && !lower_tiles_.Has(lower)) continue;
      next_.brick = 0;
      leaves_ = {};
      tiles_.Fill();
      if (is_child) ReadLower({next_.upper, lower}, leaves_, tiles_);
      return true;
    }
    if (!ReadUpper(next_.upper, lowers_, lower_tiles_)) return false;
    if (PlaceOf({next_.upper[0] >> 3, next_.upper[1] >> 3, next_.upper[2] >> 3}).upper != next_.upper) Fail();
    next_.lower = 0;
  }
}

std::unique_ptr<PartTree> NewVdbTree(std::istream& in, uint64_t begin, uint64_t end, uint64_t leaves) {
  return std::make_unique<VdbTree>(in, begin, end, leaves);
}

}  // namespace latvox::client
