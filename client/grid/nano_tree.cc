#include "client/grid/nano_tree.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <utility>
#include <vector>

namespace latvox::client {
namespace {

using TreeData = nanovdb::NanoTree<bool>::DataType;
using RootData = nanovdb::NanoRoot<bool>::DataType;
using UpperData = nanovdb::NanoUpper<bool>::DataType;
using LowerData = nanovdb::NanoLower<bool>::DataType;
using LeafData = nanovdb::NanoLeaf<bool>::DataType;

// The front of an inner node.
template <class Mask>
struct NodeFront {
  Vec3i min, max;  // of its active voxels
  uint64_t flags;
  Mask tiles, children;
};
template <class Data, class Mask>
constexpr bool kIsFront = offsetof(Data, mValueMask) == offsetof(NodeFront<Mask>, tiles) &&
                          offsetof(Data, mChildMask) == offsetof(NodeFront<Mask>, children);
static_assert(kIsFront<UpperData, UpperMask> && kIsFront<LowerData, LowerMask>);

struct LeafFront {
  Vec3i min;  // of its voxels, or of the leaf
  std::array<uint8_t, 4> facts;
  BrickMask mask, values;
};
static_assert(offsetof(LeafData, mValueMask) == offsetof(LeafFront, mask) &&
              offsetof(LeafData, mValues) == offsetof(LeafFront, values));

[[noreturn]] void Fail(const char* why) { throw std::runtime_error(why); }

// Nodes of one kind, one after the other.
struct Nodes {
  uint64_t at = 0, count = 0;
  size_t bytes = 0;  // of each
  uint64_t next = 0;
};

class NanoTree final : public PartTree {
 public:
  NanoTree(std::istream& in, const Nodes& uppers, const Nodes& lowers, const Nodes& leaves, std::vector<Vec3i> tiles)
      : PartTree(lowers.count), in_(in), uppers_(uppers), lowers_(lowers), leaves_(leaves), tiles_(std::move(tiles)) {}

  uint64_t read() const override { return lowers_.next; }

 private:
  void ReadRoot() override { uppers_.next = lowers_.next = leaves_.next = next_tile_ = 0; }

  bool ReadUpper(Vec3i& corner, UpperMask& children, UpperMask& tiles) override {
    const bool has_tile = next_tile_ < tiles_.size();
    if (uppers_.next < uppers_.count) {
      const auto front = Read<NodeFront<UpperMask>>(uppers_);
      corner = front.min;
      for (int32_t& x : corner) x &= ~int32_t{4095};
      if (!has_tile || corner < tiles_[next_tile_]) {
        ++uppers_.next;
        children = front.children;
        tiles = front.tiles;
        return true;
      }
    }
    if (!has_tile) {
      if (lowers_.next != lowers_.count || leaves_.next != leaves_.count) Fail("is damaged: it has other nodes");
      return false;
    }
    corner = tiles_[next_tile_++];
    children = {};
    tiles.Fill();
    return true;
  }

  void ReadLower(const TreePlace& first, LowerMask& children, LowerMask& tiles) override {
    const auto front = Read<NodeFront<LowerMask>>(lowers_);
    ++lowers_.next;
    const TreePlace place = PlaceOf(BrickOf(front.min));
    if (place.upper != first.upper || place.lower != first.lower) Fail("is damaged: a node is at another place");
    children = front.children;
    tiles = front.tiles;
  }

  void ReadLeaf(const TreePlace& place, BrickMask& mask) override {
    const auto front = Read<LeafFront>(leaves_);
    ++leaves_.next;
    if (BrickOf(front.min) != BrickAt(place) || front.mask != front.values) {
      Fail("is damaged: a brick is not as latvox wrote it");
    }
    mask = front.mask;
  }

  static Vec3i BrickOf(const Vec3i& voxel) { return {voxel[0] >> 3, voxel[1] >> 3, voxel[2] >> 3}; }

  // Reads the front of the next node.
  template <class Front>
  Front Read(const Nodes& nodes) {
    if (nodes.next == nodes.count) Fail("is damaged: it has other nodes");
    const auto at = static_cast<std::streamoff>(nodes.at + nodes.next * nodes.bytes);
    if (in_.tellg() != at) in_.seekg(at);
    Front front;
    in_.read(reinterpret_cast<char*>(&front), sizeof(front));
    return front;
  }

  std::istream& in_;
  Nodes uppers_, lowers_, leaves_;
  const std::vector<Vec3i> tiles_;  // of the root, by low corner
  size_t next_tile_ = 0;
};

// Reads a structure of NanoVDB's, which has no constructors, and uses it by `visit`.
template <class Data, class Visit>
auto With(std::istream& in, uint64_t at, const Visit& visit) {
  alignas(Data) std::array<char, sizeof(Data)> raw;
  if (in.tellg() != static_cast<std::streamoff>(at)) in.seekg(static_cast<std::streamoff>(at));  // a seek drops buffers
  in.read(raw.data(), raw.size());
  return visit(*reinterpret_cast<const Data*>(raw.data()));
}

// Returns the low corners of the root's active tiles.
std::vector<Vec3i> RootTiles(std::istream& in, uint64_t at, uint64_t bytes) {
  using Tile = RootData::Tile;
  if (bytes < sizeof(RootData)) Fail("its root does not lie within its grid");
  const auto count = With<RootData>(in, at, [](const RootData& root) { return uint64_t{root.mTableSize}; });
  if (count > (bytes - sizeof(RootData)) / sizeof(Tile)) Fail("its root does not lie within its grid");
  std::vector<Vec3i> tiles;
  for (uint64_t n = 0; n < count; ++n) {
    With<Tile>(in, at + sizeof(RootData) + n * sizeof(Tile), [&tiles](const Tile& tile) {
      const nanovdb::Coord corner = tile.origin();
      if (tile.isActive()) tiles.push_back({corner[0], corner[1], corner[2]});
    });
  }
  std::ranges::sort(tiles);
  return tiles;
}

}  // namespace

std::unique_ptr<PartTree> NewNanoTree(std::istream& in, const NanoFrameGrid& grid) {
  constexpr uint64_t kTreeAt = sizeof(nanovdb::GridData);
  const uint64_t bytes = grid.header.gridSize, at = grid.at + kTreeAt;
  if (bytes < kTreeAt + sizeof(TreeData)) Fail("its grid is smaller than its header");
  const uint64_t most = bytes - kTreeAt;  // of an offset
  return With<TreeData>(in, at, [&](const TreeData& tree) -> std::unique_ptr<PartTree> {
    std::array<Nodes, 3> nodes;
    const size_t sizes[] = {sizeof(LeafData), sizeof(LowerData), sizeof(UpperData)};
    for (size_t level = 0; level < nodes.size(); ++level) {
      const uint64_t first = static_cast<uint64_t>(tree.mNodeOffset[level]), count = tree.mNodeCount[level];
      if (count == 0) continue;  // then it names any place
      if (first > most || count > (most - first) / sizes[level]) Fail("its nodes do not lie within its grid");
      nodes[level] = {at + first, count, sizes[level]};
    }
    const auto root = static_cast<uint64_t>(tree.mNodeOffset[3]);
    if (root > most) Fail("its root does not lie within its grid");
    return std::make_unique<NanoTree>(in, nodes[2], nodes[1], nodes[0], RootTiles(in, at + root, most - root));
  });
}

}  // namespace latvox::client
