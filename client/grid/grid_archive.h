// The grids of a .vdb or .nvdb file, read from a stream. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_GRID_ARCHIVE_H_
#define LATVOX_CLIENT_GRID_GRID_ARCHIVE_H_

#include <istream>
#include <memory>
#include <set>
#include <string>

#include "client/grid/openvdb_trees.h"

namespace latvox::client {

// All functions throw exceptions of OpenVDB, std::runtime_error and std::ios_base::failure. OpenVDB and NanoVDB trust
// the file: damaged bytes can crash the process, or take all its memory. Not thread-safe.
class GridArchive {
 public:
  virtual ~GridArchive() = default;

  bool empty() const { return names_.empty(); }
  const std::set<std::string>& names() const { return names_; }
  bool HasGrid(const std::string& name) const { return names_.contains(name); }

  // The names of bool grids.
  const std::set<std::string>& bool_names() const { return bool_names_; }

  // Returns whether the distances of a band are the only voxels that latvox could mean.
  bool IsBand() const { return HasGrid("distance") && !HasGrid("voxels") && !bool_names_.contains("distance"); }

  // Returns the first of all names, in lexicographic order. Precondition: !empty().
  const std::string& FirstName() const { return *names_.begin(); }

  // Reads the first grid of that name. Precondition: HasGrid(name).
  virtual openvdb::GridBase::Ptr ReadGrid(const std::string& name) = 0;

 protected:
  std::set<std::string> names_, bool_names_;
};

// Opens the grids of a .vdb file. `in` must outlive the archive.
std::unique_ptr<GridArchive> OpenVdbArchive(std::istream& in);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_GRID_ARCHIVE_H_
