#include "client/output/output.h"

#include <filesystem>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/error.h"
#include "client/grid/voxel_grid.h"
#include "client/output/atomic_file.h"
#include "client/output/box_output.h"
#include "client/output/dense_output.h"
#include "client/output/picture_output.h"
#include "client/output/surface_output.h"
#include "client/output/table_output.h"

namespace latvox::client {
namespace {

// Writes a file of a grid.
using WriteGrid = absl::Status (VoxelGrid::*)(const std::string& path) const;

class GridOutput final : public Output {
 public:
  GridOutput(std::unique_ptr<AtomicFile> file, WriteGrid write) : file_(std::move(file)), write_(write) {}

  absl::Status Begin(const Accepted& accepted) override {
    if (auto status = CheckGridTransform(accepted.grid); !status.ok()) return Named(status);
    grid_.emplace(accepted.grid);
    return absl::OkStatus();
  }
  absl::Status Add(const BrickBatch& batch) override { return grid_->Add(batch); }
  absl::Status Finish(const Summary& summary) override {
    grid_->SetCertificate(summary.certificate);
    if (auto status = ((*grid_).*write_)(file_->temporary()); !status.ok()) return Named(status);
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
  WriteGrid write_;
  std::optional<VoxelGrid> grid_;
};

std::unique_ptr<Output> NewVdbOutput(std::unique_ptr<AtomicFile> file) {
  return std::make_unique<GridOutput>(std::move(file), &VoxelGrid::Write);
}

std::unique_ptr<Output> NewNvdbOutput(std::unique_ptr<AtomicFile> file) {
  return std::make_unique<GridOutput>(std::move(file), &VoxelGrid::WriteNano);
}

using NewOutput = std::unique_ptr<Output> (*)(std::unique_ptr<AtomicFile>);

constexpr std::pair<const char*, NewOutput> kFormats[] = {
    {".vdb", NewVdbOutput}, {".nvdb", NewNvdbOutput},     {".csv", NewCsvOutput},
    {".npy", NewNpyOutput}, {".ply", NewPlyOutput},       {".png", NewPictureOutput},
    {".glb", NewGlbOutput}, {".binvox", NewBinvoxOutput}, {".vox", NewVoxOutput},
};

}  // namespace

const std::vector<std::string>& OutputExtensions() {
  static const auto* const kExtensions = [] {
    auto* extensions = new std::vector<std::string>;
    for (const auto& [extension, unused] : kFormats) extensions->push_back(extension);
    return extensions;
  }();
  return *kExtensions;
}

absl::StatusOr<std::unique_ptr<Output>> OpenOutput(const std::string& path, const OutputOptions& options) {
  const std::string wanted = absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
  for (const auto& [extension, new_output] : kFormats) {
    if (wanted != extension) continue;
    auto file = AtomicFile::Create(path);
    if (!file.ok()) return file.status();
    if (options.dense_npy && new_output == NewNpyOutput) return NewDenseNpyOutput(*std::move(file));
    return new_output(*std::move(file));
  }
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": extension \"", wanted, "\" is not one of ", absl::StrJoin(OutputExtensions(), " ")));
}

}  // namespace latvox::client
