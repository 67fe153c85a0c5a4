// The grids of a .vdb file, read from a stream. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_GRID_ARCHIVE_H_
#define LATVOX_CLIENT_GRID_GRID_ARCHIVE_H_

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>

#include <istream>
#include <map>
#include <string>

#include "client/grid/openvdb_trees.h"

namespace latvox::client {

// Like openvdb::io::File, which takes only the name of a file, and reads on behind its end. All functions throw
// exceptions of OpenVDB, and std::ios_base::failure where the stream ends. OpenVDB trusts the file: damaged bytes can
// crash the process, or take all its memory. Not thread-safe.
class GridArchive : openvdb::io::Archive {
 public:
  // Reads the names of all grids; of a file that was written as a stream, the grids. `in` must outlive the archive.
  explicit GridArchive(std::istream& in);

  bool empty() const { return entries_.empty(); }
  bool HasGrid(const std::string& name) const { return entries_.contains(name); }

  // Returns the first of all names, in lexicographic order. Precondition: !empty().
  const std::string& FirstName() const { return entries_.begin()->first; }

  // Reads the first grid of that name. Precondition: HasGrid(name).
  openvdb::GridBase::Ptr ReadGrid(const std::string& name);

 private:
  struct Entry {
    openvdb::io::GridDescriptor descriptor;
    openvdb::GridBase::Ptr grid;  // of a file that was written as a stream; otherwise null
  };

  openvdb::GridBase::Ptr ReadEntry(const Entry& entry);

  std::istream& in_;
  std::multimap<std::string, Entry> entries_;  // by name
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_GRID_ARCHIVE_H_
