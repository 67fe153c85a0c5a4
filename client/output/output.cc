#include "client/output/output.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/error.h"
#include "client/grid/distance_grid.h"
#include "client/grid/voxel_grid.h"
#include "client/output/atomic_file.h"
#include "client/output/box_output.h"
#include "client/output/dense_output.h"
#include "client/output/picture_output.h"
#include "client/output/surface_output.h"
#include "client/output/table_output.h"

namespace latvox::client {
namespace {

// Grid: VoxelGrid, or DistanceGrid.
template <class Grid>
class GridOutput final : public Output {
 public:
  using NewGrid = std::function<Grid(const GridTransform&)>;
  using Write = std::function<absl::Status(Grid&, const std::string& path)>;  // a file of it

  GridOutput(std::unique_ptr<AtomicFile> file, NewGrid new_grid, Write write)
      : file_(std::move(file)), new_grid_(std::move(new_grid)), write_(std::move(write)) {}

  absl::Status Begin(const Accepted& accepted) override {
    if (auto status = CheckGridTransform(accepted.grid); !status.ok()) return Named(status);
    grid_.emplace(new_grid_(accepted.grid));
    return absl::OkStatus();
  }
  absl::Status Add(const BrickBatch& batch) override { return grid_->Add(batch); }
  absl::Status Finish(const Summary& summary) override {
    grid_->SetCertificate(summary.certificate);
    if (auto status = write_(*grid_, file_->temporary()); !status.ok()) return Named(status);
    return file_->Sync();
  }
  absl::Status Commit() override { return file_->Commit(); }

 private:
  // The same error with the target before it.
  absl::Status Named(const absl::Status& status) const {
    absl::Status named(status.code(), absl::StrCat(file_->target(), ": ", status.message()));
    SetErrorDetails(GetErrorDetails(status), named);
    return named;
  }

  std::unique_ptr<AtomicFile> file_;
  const NewGrid new_grid_;
  const Write write_;
  std::optional<Grid> grid_;
};

VoxelGrid NewVoxelGrid(const GridTransform& grid) { return VoxelGrid(grid); }

std::unique_ptr<Output> NewVdbOutput(std::unique_ptr<AtomicFile> file) {
  return std::make_unique<GridOutput<VoxelGrid>>(std::move(file), NewVoxelGrid, &VoxelGrid::Write);
}

std::unique_ptr<Output> NewNvdbOutput(std::unique_ptr<AtomicFile> file) {
  return std::make_unique<GridOutput<VoxelGrid>>(std::move(file), NewVoxelGrid, &VoxelGrid::WriteNano);
}

std::unique_ptr<Output> NewDistanceVdbOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request) {
  const bool whole = !request.region && !request.bounds && !request.shard;
  const auto new_grid = [band = *request.band, whole](const GridTransform& grid) {
    const double width = band.in_voxels ? band.width * grid.voxel_size : band.width;
    return DistanceGrid(grid, width, band.is_signed, whole);
  };
  return std::make_unique<GridOutput<DistanceGrid>>(std::move(file), new_grid, &DistanceGrid::Write);
}

using NewTable = std::unique_ptr<Output> (*)(std::unique_ptr<AtomicFile>, bool distances);

template <NewTable new_table>
std::unique_ptr<Output> NewTableOutput(std::unique_ptr<AtomicFile> file) {
  return new_table(std::move(file), /*distances=*/false);
}

template <NewTable new_table>
std::unique_ptr<Output> NewDistanceTable(std::unique_ptr<AtomicFile> file, const VoxelizeRequest&) {
  return new_table(std::move(file), /*distances=*/true);
}

using NewOutput = std::unique_ptr<Output> (*)(std::unique_ptr<AtomicFile>);

constexpr std::pair<const char*, NewOutput> kFormats[] = {
    {".vdb", NewVdbOutput},
    {".nvdb", NewNvdbOutput},
    {".csv", NewTableOutput<NewCsvOutput>},
    {".npy", NewTableOutput<NewNpyOutput>},
    {".ply", NewTableOutput<NewPlyOutput>},
    {".png", NewPictureOutput},
    {".glb", NewGlbOutput},
    {".binvox", NewBinvoxOutput},
    {".vox", NewVoxOutput},
};

using NewDistanceOutput = std::unique_ptr<Output> (*)(std::unique_ptr<AtomicFile>, const VoxelizeRequest&);

constexpr std::pair<const char*, NewDistanceOutput> kDistanceFormats[] = {
    {".vdb", NewDistanceVdbOutput},
    {".csv", NewDistanceTable<NewCsvOutput>},
    {".npy", NewDistanceTable<NewNpyOutput>},
    {".ply", NewDistanceTable<NewPlyOutput>},
};

std::string ExtensionOf(const std::string& path) {
  return absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
}

absl::Status WrongExtension(const std::string& path, const std::vector<std::string>& extensions) {
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": extension \"", ExtensionOf(path), "\" is not one of ", absl::StrJoin(extensions, " ")));
}

absl::StatusOr<std::unique_ptr<Output>> OpenDistanceOutput(const std::string& path, const VoxelizeRequest& request) {
  for (const auto& [extension, new_output] : kDistanceFormats) {
    if (ExtensionOf(path) != extension) continue;
    auto file = AtomicFile::Create(path);
    if (!file.ok()) return file.status();
    return new_output(*std::move(file), request);
  }
  return WrongExtension(path, DistanceExtensions());
}

}  // namespace

std::vector<std::string> DistanceExtensions() {
  std::vector<std::string> extensions;
  for (const auto& [extension, unused] : kDistanceFormats) extensions.push_back(extension);
  return extensions;
}

bool CarriesDistances(const std::string& path) {
  const std::vector<std::string> extensions = DistanceExtensions();
  return std::find(extensions.begin(), extensions.end(), ExtensionOf(path)) != extensions.end();
}

const std::vector<std::string>& OutputExtensions() {
  static const auto* const kExtensions = [] {
    auto* extensions = new std::vector<std::string>;
    for (const auto& [extension, unused] : kFormats) extensions->push_back(extension);
    return extensions;
  }();
  return *kExtensions;
}

absl::StatusOr<std::unique_ptr<Output>> OpenOutput(const std::string& path, const VoxelizeRequest& request,
                                                   const OutputOptions& options) {
  if (request.band) return OpenDistanceOutput(path, request);
  const std::string wanted = ExtensionOf(path);
  for (const auto& [extension, new_output] : kFormats) {
    if (wanted != extension) continue;
    auto file = AtomicFile::Create(path);
    if (!file.ok()) return file.status();
    if (options.dense_npy && wanted == ".npy") return NewDenseNpyOutput(*std::move(file));
    return new_output(*std::move(file));
  }
  return WrongExtension(path, OutputExtensions());
}

}  // namespace latvox::client
