#include "client/tool/output/grid_output.h"

#include <functional>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/tool/vdb/brick_grid.h"
#include "client/tool/vdb/vdb.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

class GridOutput final : public Output {
 public:
  using NewGrid = std::function<Vdb::NewGrid(const Vdb*, const Accepted&)>;  // null if NeedsOpenVdb is false

  GridOutput(std::unique_ptr<AtomicFile> file, VdbFormat format, const VoxelizeRequest& request,
             const OutputOptions& options, NewGrid new_grid)
      : file_(std::move(file)),
        format_(format),
        request_(request),
        note_(options.note),
        metadata_(options.metadata),
        new_grid_(std::move(new_grid)) {}

  void SetNames(const CarriedNames& names) override { names_ = names; }
  absl::Status Begin(const Accepted& accepted) override {
    const Vdb* loaded = nullptr;
    if (NeedsOpenVdb(format_, request_.fields)) {
      const auto vdb = Vdb::Load();
      if (!vdb.ok()) return vdb.status();
      loaded = *vdb;
    }
    auto grid = new_grid_(loaded, accepted);
    if (!grid.ok()) return Named(grid.status());
    grid_ = *std::move(grid);
    note_.facts = accepted.mesh;
    request_.placement = accepted.placement;  // the metadata state it, whatever a later version's default is
    return absl::OkStatus();
  }
  absl::Status Add(const BrickBatch& batch) override { return grid_->Add(batch); }
  absl::Status Finish(const Summary& summary) override {
    if (!note_.quantization) note_.quantization = static_cast<int>(summary.certificate.quantization_bits);
    if (metadata_) {
      grid_->SetMetadata(*metadata_);
    } else {
      grid_->Describe(request_, note_, names_, summary);
    }
    const absl::Status written = grid_->Write(file_->temporary(), format_, file_->cancellation());
    if (!written.ok()) return file_->Named(written);
    return file_->Sync();
  }
  absl::Status Commit() override { return file_->Commit(); }

 private:
  // Returns the error with the target before it.
  absl::Status Named(const absl::Status& status) const {
    absl::Status named(status.code(), absl::StrCat(file_->target(), ": ", status.message()));
    SetErrorDetails(GetErrorDetails(status), named);
    return named;
  }

  std::unique_ptr<AtomicFile> file_;
  const VdbFormat format_;
  VoxelizeRequest request_;
  MeshNote note_;
  const std::optional<MetadataPairs> metadata_;
  const NewGrid new_grid_;
  CarriedNames names_;
  std::unique_ptr<VdbGrid> grid_;
};

// Returns what makes the grid of a file. A band with distances alone is a level set, as far as it is one.
GridOutput::NewGrid NewGridFor(VdbFormat format, const VoxelizeRequest& request) {
  const std::vector<Field>& fields = request.fields;
  if (!NeedsOpenVdb(format, fields))
    return [](const Vdb*, const Accepted& accepted) { return NewBrickGrid(accepted.grid); };
  if (fields.empty()) return [](const Vdb* vdb, const Accepted& accepted) { return vdb->NewVoxelGrid(accepted.grid); };
  const auto* const band = std::get_if<Band>(&request.set);
  if (band == nullptr || fields != std::vector<Field>{Field::kDistance}) {
    return [fields](const Vdb* vdb, const Accepted& accepted) {
      return vdb->NewFieldGrids(accepted.grid, fields, accepted.fraction_labels, accepted.neighbors);
    };
  }
  const bool whole = !request.region && !request.bounds && !request.shard;
  return [band = *band, is_signed = request.signed_distance, whole](const Vdb* vdb, const Accepted& accepted) {
    const GridTransform& grid = accepted.grid;
    const double width = band.in_voxels ? band.width * grid.voxel_size : band.width;
    return vdb->NewDistanceGrid(grid, width, is_signed, whole);
  };
}

}  // namespace

bool NeedsOpenVdb(VdbFormat format, const std::vector<Field>& fields) {
  return format != VdbFormat::kOpenVdb || !fields.empty();
}

std::unique_ptr<Output> NewGridOutput(std::unique_ptr<AtomicFile> file, VdbFormat format,
                                      const VoxelizeRequest& request, const OutputOptions& options) {
  return std::make_unique<GridOutput>(std::move(file), format, request, options, NewGridFor(format, request));
}

}  // namespace latvox::client
