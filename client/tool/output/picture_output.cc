#include "client/tool/output/picture_output.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

#include "client/internal/vec3.h"
#include "client/tool/output/picture.h"
#include "client/tool/output/picture_scene.h"
#include "client/tool/output/voxel_colors.h"

namespace latvox::client {
namespace {

// Returns the part of the mesh's box that can hold voxels: with a region, it is smaller than the mesh. Voxels of a file
// have no mesh.
std::pair<Vec3d, Vec3d> Visible(const Accepted& accepted) {
  Vec3d low = accepted.mesh.min, high = accepted.mesh.max;
  if (!accepted.index_box) return {low, high};
  Vec3d box_low{}, box_high{};
  for (int corner = 0; corner < 8; ++corner) {
    Vec3i ijk{};
    for (size_t m = 0; m < 3; ++m)
      ijk[m] = corner >> m & 1 ? accepted.index_box->max[m] - 1 : accepted.index_box->min[m];
    const Vec3d world = accepted.grid.ToWorld(ijk);
    for (size_t m = 0; m < 3; ++m) {
      box_low[m] = corner == 0 ? world[m] : std::min(box_low[m], world[m]);
      box_high[m] = corner == 0 ? world[m] : std::max(box_high[m], world[m]);
    }
  }
  if (accepted.mesh.triangles == 0) return {box_low, box_high};
  for (size_t m = 0; m < 3; ++m) {
    low[m] = std::max(low[m], box_low[m]);
    high[m] = std::max(low[m], std::min(high[m], box_high[m]));
  }
  return {low, high};
}

class PictureOutput final : public Output {
 public:
  PictureOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request, UpAxis up)
      : file_(std::move(file)),
        traits_{request.fields},
        shows_skin_(std::holds_alternative<Band>(request.set) &&
                    std::ranges::find(request.fields, Field::kDistance) != request.fields.end()),
        options_{.up = up, .cancellation = file_->cancellation()} {}

  absl::Status Begin(const Accepted& accepted) override {
    const auto [low, high] = Visible(accepted);
    const double diagonal = Length(Sum(high, -1, low)) + accepted.grid.voxel_size;
    skin_depth_ = SkinDepth(accepted.grid);
    scene_.emplace(accepted.grid, ShiftFor(accepted.grid, diagonal, options_));
    return absl::OkStatus();
  }

  absl::Status Add(const BrickBatch& batch) override {
    auto colors = ColorsOf(batch, traits_, DefaultColorBy(traits_));
    if (!colors.ok()) return colors.status();
    if (shows_skin_) {
      const std::vector<Brick> skin = SkinOf(batch, skin_depth_, *colors);
      AddBricks(skin, *colors, *scene_);
    } else {
      AddBricks(batch.bricks, *colors, *scene_);
    }
    return absl::OkStatus();
  }

  absl::Status Finish(const Summary&) override {
    scene_->Seal();
    const auto png = DrawVoxels(*scene_, options_);
    if (!png.ok()) return png.status();
    if (auto status = file_->Append(*png); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  std::unique_ptr<AtomicFile> file_;
  const VoxelTraits traits_;
  const bool shows_skin_;  // of a band
  const PictureOptions options_;
  double skin_depth_ = 0;  // of a band
  std::optional<VoxelScene> scene_;
};

}  // namespace

std::unique_ptr<Output> NewPictureOutput(std::unique_ptr<AtomicFile> file, const VoxelizeRequest& request, UpAxis up) {
  return std::make_unique<PictureOutput>(std::move(file), request, up);
}

}  // namespace latvox::client
