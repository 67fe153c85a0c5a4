#include "client/grid/nano_archive.h"

#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/grid/metadata_types.h"
#include "client/grid/nano_codec.h"
#include "client/grid/nano_facts.h"
#include "client/grid/nano_frame.h"
#include "client/grid/openvdb_metadata.h"
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
    const auto& data = *node.data();  // for which node.beginChild() is const in some versions only
    for (auto child = data.mChildMask.beginOn(); child; ++child) AddNode(*data.getChild(*child), tree);
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
    for (NanoFrameGrid& grid : ReadNanoFrame(in_)) {
      names_.insert(grid.name);
      if (grid.header.gridType == nanovdb::GridType::Boolean) bool_names_.insert(grid.name);
      grids_.emplace(grid.name, std::move(grid));
    }
  }

  openvdb::GridBase::Ptr ReadGrid(const std::string& name) override {
    const NanoFrameGrid& frame = grids_.at(name);
    auto buffer = ReadNanoGrid(in_, frame);
    auto& data = *reinterpret_cast<nanovdb::GridData*>(buffer.data());
    CheckNanoData(frame, data);
    data.mGridIndex = 0;  // a handle would look for the grids of the file, and only one is here
    data.mGridCount = 1;
    const nanovdb::GridHandle<> handle(std::move(buffer));
    openvdb::GridBase::Ptr grid = ToOpenGrid(handle);
    if (!grid) {
      const std::string type = data.mGridType < nanovdb::GridType::End ? NanoTypeName(data.mGridType) : "?";
      throw std::runtime_error(absl::StrCat("the grid \"", Printable(name), "\" is a ", type,
                                            ", neither a bool, a float, an int32 nor a Vec3f"));
    }
    const auto metadata = NanoMetadata(data, [&handle](uint64_t at, void* to, uint64_t bytes) {
      const uint64_t size = handle.buffer().bufferSize();
      if (at > size || bytes > size - at) return false;
      std::memcpy(to, reinterpret_cast<const char*>(handle.data()) + at, bytes);
      return true;
    });
    DescribeNano(name, data, metadata, *grid);
    return grid;
  }

 private:
  std::istream& in_;
  std::map<std::string, NanoFrameGrid> grids_;  // the first of each name
};

}  // namespace

std::unique_ptr<GridArchive> OpenNanoArchive(std::istream& in) { return std::make_unique<NanoArchive>(in); }

void DescribeNano(const std::string& name, const nanovdb::GridData& data,
                  const std::vector<std::pair<std::string, std::string>>& metadata, openvdb::GridBase& grid) {
  grid.setName(name);
  grid.setTransform(MakeTransform(NanoTransform(data)));
  if (data.mGridClass == nanovdb::GridClass::LevelSet) grid.setGridClass(openvdb::GRID_LEVEL_SET);
  InsertMetadata(TypedMetadata(metadata), grid);
}

}  // namespace latvox::client
