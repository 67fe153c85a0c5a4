#include "client/grid/nano_archive.h"

#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/grid/grid_metadata.h"
#include "client/grid/metadata_types.h"
#include "client/grid/nano_facts.h"
#include "client/internal/printable.h"

namespace latvox::client {
namespace {

template <class Value>
Value ToOpen(Value value) {
  return value;
}
openvdb::Vec3s ToOpen(const nanovdb::Vec3f& value) { return {value[0], value[1], value[2]}; }
openvdb::Coord ToOpen(const nanovdb::Coord& ijk) { return {ijk[0], ijk[1], ijk[2]}; }

// Adds the active voxels and tiles below the node.
template <class Node, class Tree>
void AddNode(const Node& node, Tree& tree) {
  if constexpr (Node::LEVEL == 0) {
    auto& leaf = *tree.touchLeaf(ToOpen(node.origin()));
    for (auto value = node.beginValueOn(); value; ++value) leaf.setValueOn(value.pos(), ToOpen(*value));
  } else {
    for (auto tile = node.beginValueOn(); tile; ++tile) {  // whose getOrigin() some versions do not compile
      tree.addTile(Node::LEVEL, ToOpen(node.offsetToGlobalCoord(tile.pos())), ToOpen(*tile), /*active=*/true);
    }
    for (auto child = node.beginChild(); child; ++child) AddNode(*child, tree);
  }
}

// NanoVDB's own converter starts threads, which a process without rights may not do.
template <class Grid, class NanoGrid>
openvdb::GridBase::Ptr ToOpenGrid(const NanoGrid& nano) {
  const auto grid = Grid::create();
  openvdb::tree::ValueAccessor<typename Grid::TreeType> tree(grid->tree());
  const auto& root = *nano.tree().root().data();
  for (uint32_t n = 0; n < root.mTableSize; ++n) {
    const auto* const tile = root.tile(n);
    if (tile->isChild()) {
      AddNode(*root.getChild(tile), tree);
    } else if (tile->state) {
      tree.addTile(Grid::TreeType::RootNodeType::LEVEL, ToOpen(tile->origin()), ToOpen(tile->value), /*active=*/true);
    }
  }
  return grid;
}

openvdb::GridBase::Ptr ToOpenGrid(const nanovdb::GridHandle<>& handle) {
  if (const auto* const nano = handle.grid<bool>()) return ToOpenGrid<openvdb::BoolGrid>(*nano);
  if (const auto* const nano = handle.grid<float>()) return ToOpenGrid<openvdb::FloatGrid>(*nano);
  if (const auto* const nano = handle.grid<int32_t>()) return ToOpenGrid<openvdb::Int32Grid>(*nano);
  if (const auto* const nano = handle.grid<nanovdb::Vec3f>()) return ToOpenGrid<openvdb::Vec3SGrid>(*nano);
  return nullptr;
}

class NanoArchive final : public GridArchive {
 public:
  explicit NanoArchive(std::istream& in) : in_(in) {
    in_.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
    in_.seekg(0, std::ios::end);
    const auto size = static_cast<uint64_t>(in_.tellg());
    in_.seekg(0);
    for (uint64_t at = 0; at < size;) at = ReadSegment(size);
  }

  openvdb::GridBase::Ptr ReadGrid(const std::string& name) override {
    const Place& place = places_.at(name);
    auto buffer = nanovdb::HostBuffer::create(place.bytes);
    in_.seekg(static_cast<std::streamoff>(place.at));
    in_.read(reinterpret_cast<char*>(buffer.data()), static_cast<std::streamsize>(place.bytes));
    auto& data = *reinterpret_cast<nanovdb::GridData*>(buffer.data());
    if (!IsNanoMagic(data.mMagic)) throw std::runtime_error("it has no grid behind its header");
    if (data.mGridSize > place.bytes) throw std::runtime_error("it is cut short");
    data.mGridIndex = 0;  // a handle would look for the grids of the file, and only one is here
    data.mGridCount = 1;
    const nanovdb::GridHandle<> handle(std::move(buffer));
    openvdb::GridBase::Ptr grid = ToOpenGrid(handle);
    if (!grid) {
      const std::string type = data.mGridType < nanovdb::GridType::End ? NanoTypeName(data.mGridType) : "?";
      throw std::runtime_error(absl::StrCat("the grid \"", Printable(name), "\" is a ", type,
                                            ", neither a bool, a float, an int32 nor a Vec3f"));
    }
    grid->setName(name);
    grid->setTransform(MakeTransform(NanoTransform(data)));
    if (data.mGridClass == nanovdb::GridClass::LevelSet) grid->setGridClass(openvdb::GRID_LEVEL_SET);
    InsertTexts(NanoMetadata(data,
                             [&handle](uint64_t at, void* to, uint64_t bytes) {
                               if (at > handle.size() || bytes > handle.size() - at) return false;
                               std::memcpy(to, reinterpret_cast<const char*>(handle.data()) + at, bytes);
                               return true;
                             }),
                *grid);
    return grid;
  }

 private:
  struct Place {
    uint64_t at, bytes;
  };

  template <class T>
  T Get() {
    T value;
    in_.read(reinterpret_cast<char*>(&value), sizeof(value));
    return value;
  }

  // Reads the names of a segment's grids, and goes to its end, which it returns. Throws std::runtime_error.
  uint64_t ReadSegment(uint64_t size) {
    const auto header = Get<NanoFileHeader>();
    if (!IsNanoMagic(header.magic)) throw std::runtime_error("it goes on with something else");
    if (header.version.getMajor() != NANOVDB_MAJOR_VERSION_NUMBER) {
      throw std::runtime_error(absl::StrCat("it has version ", header.version.getMajor(), " of the format, not ",
                                            NANOVDB_MAJOR_VERSION_NUMBER));
    }
    std::vector<std::pair<std::string, uint64_t>> grids;
    for (uint16_t n = 0; n < header.gridCount; ++n) {
      const auto grid = Get<NanoMetaData>();
      if (grid.codec != nanovdb::io::Codec::NONE) throw std::runtime_error("it is compressed");
      if (grid.nameSize > kMostNanoText) throw std::runtime_error("the name of a grid is too long");
      std::string name(grid.nameSize, '\0');
      in_.read(name.data(), static_cast<std::streamsize>(name.size()));
      grids.emplace_back(name.c_str(), grid.gridSize);
    }
    auto at = static_cast<uint64_t>(in_.tellg());
    for (const auto& [name, bytes] : grids) {
      if (bytes > size - at) throw std::runtime_error("it is cut short");
      if (bytes < sizeof(nanovdb::GridData)) throw std::runtime_error("a grid is smaller than its header");
      names_.insert(name);
      places_.emplace(name, Place{at, bytes});
      at += bytes;
    }
    in_.seekg(static_cast<std::streamoff>(at));
    return at;
  }

  std::istream& in_;
  std::map<std::string, Place> places_;  // of the first grid of each name
};

}  // namespace

bool IsNanoFile(std::istream& in) {
  uint64_t magic = 0;
  in.read(reinterpret_cast<char*>(&magic), sizeof(magic));
  in.clear();
  in.seekg(0);
  return IsNanoMagic(magic);
}

std::unique_ptr<GridArchive> OpenNanoArchive(std::istream& in) { return std::make_unique<NanoArchive>(in); }

}  // namespace latvox::client
