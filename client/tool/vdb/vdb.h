// OpenVDB and the part of latvox::grid that needs it, loaded when a call needs it.
#ifndef LATVOX_CLIENT_TOOL_VDB_VDB_H_
#define LATVOX_CLIENT_TOOL_VDB_VDB_H_

#include <functional>
#include <istream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/grid/difference_file.h"
#include "latvox/cancellation.h"
#include "latvox/grid/carried_names.h"
#include "latvox/grid/grid_content.h"
#include "latvox/grid/merge.h"
#include "latvox/types.h"

namespace latvox::client {

enum class VdbFormat { kOpenVdb, kNanoVdb };  // .vdb, .nvdb

// A VoxelGrid, DistanceGrid or FieldGrids that is being filled. Not thread-safe.
class VdbGrid {
 public:
  virtual ~VdbGrid() = default;
  virtual absl::Status Add(const BrickBatch& batch) = 0;

  // Writes the metadata. Only FieldGrids keep the names.
  virtual void Describe(const VoxelizeRequest& request, const MeshNote& note, const CarriedNames& names,
                        const Summary& summary) = 0;

  // Writes metadata that were read from a file, over those of Describe.
  virtual void SetMetadata(const std::vector<std::pair<std::string, std::string>>& metadata) = 0;

  // Writes the file to `path`. Errors as those of the grid's own function, Write or WriteNano.
  virtual absl::Status Write(const std::string& path, VdbFormat format, const Cancellation& cancellation) = 0;
};

// How far OpenVDB is loaded: not at all; in a thread that nobody has waited for; or as far as it can be.
enum class VdbState { kAbsent, kLoading, kLoaded };

// The functions of latvox::grid that need OpenVDB. Errors and memory are those of the named functions. Thread-safe.
class Vdb {
 public:
  // Starts to load it in a thread, so that a later Load waits less. Errors: those of Load that need no loading: its
  // file is missing.
  static absl::Status Prepare();

  // Loads it, once for the process, and returns it; it stays loaded. A process that gives up its rights loads it
  // before. Errors: FAILED_PRECONDITION, with the file: it is missing, of another version, or lacks a library;
  // RESOURCE_EXHAUSTED: memory.
  static absl::StatusOr<const Vdb*> Load();

  // In the state kLoading, a process must end by _exit: OpenVDB's libraries must not start while they end.
  static VdbState State();

  // Return an empty grid. Errors: those of CheckGridTransform.
  using NewGrid = absl::StatusOr<std::unique_ptr<VdbGrid>>;
  virtual NewGrid NewVoxelGrid(const GridTransform& transform) const = 0;
  virtual NewGrid NewDistanceGrid(const GridTransform& transform, double width, bool is_signed, bool whole) const = 0;
  virtual NewGrid NewFieldGrids(const GridTransform& transform, const std::vector<Field>& fields,
                                const std::vector<uint32_t>& fraction_labels,
                                const std::vector<Vec3i>& neighbors) const = 0;

  // As in client/grid/grid_stream.h, and, for a file that this process wrote, ReadGridContent.
  virtual absl::StatusOr<GridFileInfo> ReadInfo(std::istream& in, const std::string& path) const = 0;
  virtual absl::StatusOr<GridContent> ReadContent(std::istream& in, const std::string& path, bool values) const = 0;
  virtual absl::StatusOr<GridContent> ReadOwnContent(const std::string& path) const = 0;

  // MergeParts and WriteDifferenceFile.
  virtual absl::StatusOr<MergedGrid> Merge(const std::vector<std::string>& parts, const std::string& path,
                                           const Cancellation& cancellation,
                                           const std::function<void(double, uint64_t)>& progress,
                                           const ReadPart& read) const = 0;
  virtual absl::Status WriteDifference(const GridDifference& difference, const GridTransform& transform,
                                       const std::string& path, const Cancellation& cancellation) const = 0;

 protected:
  ~Vdb() = default;  // it stays loaded
};

// The one symbol of the module. Returns null if `version`, that of the program, is not the module's.
extern "C" __attribute__((visibility("default"))) const Vdb* latvox_vdb(const char* version);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_VDB_VDB_H_
