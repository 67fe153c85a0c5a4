#include "client/grid/grid_archive.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

namespace latvox::client {
namespace {

// Like openvdb::io::File, which takes only the name of a file, and reads on behind its end.
class VdbArchive final : public GridArchive, openvdb::io::Archive {
 public:
  // Reads the names of all grids; of a file that was written as a stream, the grids.
  explicit VdbArchive(std::istream& in) : in_(in) {
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
      names_.insert(entry.descriptor.gridName());
      if (entry.descriptor.gridType() == openvdb::BoolGrid::gridType()) bool_names_.insert(entry.descriptor.gridName());
      entries_.emplace(entry.descriptor.gridName(), std::move(entry));
    }
  }

  openvdb::GridBase::Ptr ReadGrid(const std::string& name) override {
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

 private:
  struct Entry {
    openvdb::io::GridDescriptor descriptor;
    openvdb::GridBase::Ptr grid;  // of a file that was written as a stream; otherwise null
  };

  openvdb::GridBase::Ptr ReadEntry(const Entry& entry) {
    if (entry.grid) return entry.grid;
    const openvdb::io::GridDescriptor& descriptor = entry.descriptor;
    const openvdb::GridBase::Ptr grid = openvdb::GridBase::createGrid(descriptor.gridType());
    if (descriptor.saveFloatAsHalf()) grid->setSaveFloatAsHalf(true);
    descriptor.seekToGrid(in_);
    readGrid(grid, descriptor, in_);
    return grid;
  }

  std::istream& in_;
  std::multimap<std::string, Entry> entries_;  // by name
};

}  // namespace

std::unique_ptr<GridArchive> OpenVdbArchive(std::istream& in) { return std::make_unique<VdbArchive>(in); }

}  // namespace latvox::client
