#include "client/tool/vdb/brick_grid.h"

#include <oneapi/tbb/task_arena.h>

#include <new>
#include <utility>

#include "client/grid/brick_tree.h"
#include "client/grid/grid_metadata.h"
#include "client/grid/grid_transform.h"
#include "client/grid/metadata_types.h"
#include "client/grid/request_metadata.h"
#include "client/grid/voxel_file.h"
#include "client/grid/warning_metadata.h"
#include "deploy/process/exhaustion.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

class BrickGrid final : public VdbGrid {
 public:
  explicit BrickGrid(const GridTransform& transform)
      : transform_(TransformBytes(transform)), metadata_(PlaceMetadata(transform)) {
    metadata_["name"] = ToMetadata("voxels");
  }

  absl::Status Add(const BrickBatch& batch) override try {
    tree_.Add(batch.bricks);
    return absl::OkStatus();
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError("not enough memory for the voxels");
  }
  void Describe(const VoxelizeRequest& request, const MeshNote& note, const CarriedNames&,
                const Summary& summary) override {
    metadata_.merge(RequestMetadata(request, note));
    metadata_.merge(CertificateMetadata(summary.certificate));
    metadata_.merge(WarningMetadata(summary.warnings));
  }
  void SetMetadata(const std::vector<std::pair<std::string, std::string>>& metadata) override {
    Metadata read = TypedMetadata(metadata);
    read.merge(std::move(metadata_));
    metadata_ = std::move(read);
  }
  absl::Status Write(const std::string& path, VdbFormat, const Cancellation& cancellation) override {
    const auto describe = [this](const VoxelCounts&) { return metadata_; };
    oneapi::tbb::task_arena arena(HasAddressesForThreads() ? oneapi::tbb::task_arena::automatic : 1);
    return arena.execute([&] { return WriteVoxelFile(tree_, transform_, describe, path, cancellation); });
  }

 private:
  const std::string transform_;
  Metadata metadata_;
  BrickTree tree_;
};

}  // namespace

Vdb::NewGrid NewBrickGrid(const GridTransform& transform) {
  if (absl::Status status = CheckGridTransform(transform); !status.ok()) return status;
  return std::make_unique<BrickGrid>(transform);
}

}  // namespace latvox::client
