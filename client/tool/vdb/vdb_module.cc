#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "absl/strings/string_view.h"
#include "client/grid/grid_stream.h"
#include "client/tool/vdb/vdb.h"
#include "latvox/grid/distance_grid.h"
#include "latvox/grid/field_grids.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

template <class Grid>
class AnyGrid final : public VdbGrid {
 public:
  explicit AnyGrid(Grid grid) : grid_(std::move(grid)) {}

  absl::Status Add(const BrickBatch& batch) override { return grid_.Add(batch); }
  void Describe(const VoxelizeRequest& request, const MeshNote& note, const CarriedNames& names,
                const Summary& summary) override {
    grid_.SetRequest(request, note);
    grid_.SetCertificate(summary.certificate);
    if constexpr (std::is_same_v<Grid, FieldGrids>) grid_.SetNames(names);
    grid_.SetWarnings(summary.warnings);
  }
  void SetMetadata(const std::vector<std::pair<std::string, std::string>>& metadata) override {
    grid_.SetMetadata(metadata);
  }
  absl::Status Write(const std::string& path, VdbFormat format, const Cancellation& cancellation) override {
    return format == VdbFormat::kNanoVdb ? grid_.WriteNano(path, cancellation) : grid_.Write(path, cancellation);
  }

 private:
  Grid grid_;
};

// Returns the grid Grid(transform, facts...).
template <class Grid, class... Facts>
Vdb::NewGrid New(const GridTransform& transform, const Facts&... facts) {
  if (absl::Status status = CheckGridTransform(transform); !status.ok()) return status;
  return std::make_unique<AnyGrid<Grid>>(Grid(transform, facts...));
}

class Module final : public Vdb {
 public:
  NewGrid NewVoxelGrid(const GridTransform& transform) const override { return New<VoxelGrid>(transform); }
  NewGrid NewDistanceGrid(const GridTransform& transform, double width, bool is_signed, bool whole) const override {
    return New<DistanceGrid>(transform, width, is_signed, whole);
  }
  NewGrid NewFieldGrids(const GridTransform& transform, const std::vector<Field>& fields,
                        const std::vector<uint32_t>& fraction_labels,
                        const std::vector<Vec3i>& neighbors) const override {
    return New<FieldGrids>(transform, fields, fraction_labels, neighbors);
  }
  absl::StatusOr<GridFileInfo> ReadInfo(std::istream& in, const std::string& path) const override {
    return ReadGridFileInfo(in, path);
  }
  absl::StatusOr<GridContent> ReadContent(std::istream& in, const std::string& path, bool values) const override {
    return ReadGridContent(in, path, values);
  }
  absl::StatusOr<GridContent> ReadOwnContent(const std::string& path) const override { return ReadGridContent(path); }
  absl::StatusOr<MergedGrid> Merge(const std::vector<std::string>& parts, const std::string& path,
                                   const Cancellation& cancellation,
                                   const std::function<void(double, uint64_t)>& progress,
                                   const ReadPart& read) const override {
    return MergeParts(parts, path, cancellation, progress, read);
  }
  absl::Status WriteDifference(const GridDifference& difference, const GridTransform& transform,
                               const std::string& path, const Cancellation& cancellation) const override {
    return WriteDifferenceFile(difference, transform, path, cancellation);
  }
};

}  // namespace

const Vdb* latvox_vdb(const char* version) {
  static const Module module;
  return version == absl::string_view(LATVOX_VERSION) ? &module : nullptr;
}

}  // namespace latvox::client
