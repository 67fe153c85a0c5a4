#include "client/grid/grid_archive.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace latvox::client {

GridArchive::GridArchive(std::istream& in) : in_(in) {
  in_.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
  readHeader(in_);
  setFormatVersion(in_);
  setLibraryVersion(in_);
  setDataCompression(in_);
  openvdb::MetaMap().readMeta(in_);
  for (int32_t left = readGridCount(in_); left > 0; --left) {
    Entry entry;
    const openvdb::GridBase::Ptr grid = entry.descriptor.read(in_);
    if (inputHasGridOffsets()) {
      entry.descriptor.seekToEnd(in_);
    } else {
      readGrid(grid, entry.descriptor, in_);
      entry.grid = grid;
    }
    entries_.emplace(entry.descriptor.gridName(), std::move(entry));
  }
}

openvdb::GridBase::Ptr GridArchive::ReadEntry(const Entry& entry) {
  if (entry.grid) return entry.grid;
  const openvdb::io::GridDescriptor& descriptor = entry.descriptor;
  const openvdb::GridBase::Ptr grid = openvdb::GridBase::createGrid(descriptor.gridType());
  if (descriptor.saveFloatAsHalf()) grid->setSaveFloatAsHalf(true);
  descriptor.seekToGrid(in_);
  readGrid(grid, descriptor, in_);
  return grid;
}

openvdb::GridBase::Ptr GridArchive::ReadGrid(const std::string& name) {
  const Entry& entry = entries_.find(name)->second;
  const openvdb::GridBase::Ptr grid = ReadEntry(entry);
  if (!entry.descriptor.isInstance()) return grid;
  const auto owner = std::find_if(entries_.begin(), entries_.end(), [&](const auto& each) {
    const openvdb::io::GridDescriptor& descriptor = each.second.descriptor;
    return descriptor.uniqueName() == entry.descriptor.instanceParentName() && !descriptor.isInstance();
  });
  if (owner == entries_.end()) throw std::runtime_error("a grid has the tree of a grid that is not there");
  grid->setTree(ReadEntry(owner->second)->baseTreePtr());
  return grid;
}

}  // namespace latvox::client
