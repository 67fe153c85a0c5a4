#include "latvox/grid/voxel_grid.h"

#include <openvdb/tools/Prune.h>

#include <algorithm>
#include <new>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/grid/grid_file.h"
#include "client/grid/grid_metadata.h"
#include "client/grid/grid_reading.h"
#include "client/grid/grid_stream.h"
#include "client/grid/metadata_types.h"
#include "client/grid/nano_file.h"
#include "client/grid/open_file.h"
#include "client/grid/openvdb_metadata.h"
#include "client/grid/request_metadata.h"
#include "client/grid/tree_nodes.h"
#include "client/grid/warning_metadata.h"
#include "client/internal/printable.h"
#include "latvox/grid/openvdb_grid.h"

namespace latvox::client {
namespace {

// The most voxels in active tiles. A few bytes of a file could stand for gigabytes of bricks.
constexpr uint64_t kMostTileVoxels = uint64_t{1} << 34;

// Calls visit(brick_ijk) for each brick of active tiles.
template <class Visit>
void ForEachTileBrick(const openvdb::BoolTree& tree, const Visit& visit) {
  auto tile = tree.cbeginValueOn();
  tile.setMaxDepth(openvdb::BoolTree::ValueOnCIter::LEAF_DEPTH - 1);
  for (; tile; ++tile) {
    openvdb::CoordBBox box;
    tile.getBoundingBox(box);
    const openvdb::CoordBBox bricks(box.min() >> Leaf::LOG2DIM, box.max() >> Leaf::LOG2DIM);
    for (auto ijk = bricks.begin(); ijk; ++ijk) visit(Vec3i{(*ijk)[0], (*ijk)[1], (*ijk)[2]});
  }
}

// Returns the bricks in lexicographic order; those of active tiles are full. Errors: INVALID_ARGUMENT, with the path.
absl::StatusOr<std::vector<Brick>> SortedBricks(const openvdb::BoolTree& tree, const std::string& path) {
  const uint64_t voxels = tree.activeVoxelCount() - tree.activeLeafVoxelCount();
  if (voxels > kMostTileVoxels) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": has active tiles of ", voxels, " voxels, more than ", kMostTileVoxels));
  }
  std::vector<Brick> bricks;
  bricks.reserve(tree.leafCount() + voxels / Leaf::SIZE);
  for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
    if (!leaf->isEmpty()) bricks.push_back(ToBrick(*leaf));
  }
  if (voxels > 0) ForEachTileBrick(tree, [&bricks](const Vec3i& ijk) { bricks.push_back({ijk, kFullBrick}); });
  std::ranges::sort(bricks, {}, &Brick::brick_ijk);
  return bricks;
}

absl::StatusOr<GridFile> Content(const openvdb::GridBase::Ptr& first, const std::string& path) {
  const auto grid = openvdb::gridPtrCast<openvdb::BoolGrid>(first);
  if (!grid) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": the grid \"", Printable(first->getName()), "\" is a ", first->type(),
                     "; voxels are read from a bool grid, and distances of a band from a float grid with the name "
                     "\"distance\". Write the mask of the grid as a bool grid, or give the distances that name"));
  }
  if (auto status = CheckTransform(*grid, path); !status.ok()) return status;
  auto bricks = SortedBricks(grid->tree(), path);
  if (!bricks.ok()) return bricks.status();
  return GridFile{Describe(*grid), *std::move(bricks)};
}

absl::Status NoMemoryForVoxels() { return absl::ResourceExhaustedError("not enough memory for the OpenVDB grid"); }

// Returns the name of the grid that is read. Files of other programs have other names, and grids of other types.
absl::StatusOr<std::string> SetName(const GridArchive& archive, const std::string& path) {
  if (archive.empty()) return NoGrid(path);
  if (archive.HasGrid("voxels")) return "voxels";
  if (archive.IsBand()) return "distance";
  const std::set<std::string>& names = archive.bool_names();
  if (names.empty()) return archive.FirstName();
  if (names.size() == 1) return *names.begin();
  return absl::InvalidArgumentError(absl::StrCat(path, ": has the bool grids ", Printable(absl::StrJoin(names, ", ")),
                                                 "; latvox reads the one with the name \"voxels\", or the only one"));
}

}  // namespace

VoxelGrid::VoxelGrid(const GridTransform& transform) : content_(std::make_unique<Content>()) {
  openvdb::initialize();
  content_->grid = openvdb::BoolGrid::create(false);
  openvdb::BoolGrid& grid = *content_->grid;
  grid.setName("voxels");
  Place(transform, grid);
}

VoxelGrid::VoxelGrid(VoxelGrid&&) noexcept = default;
VoxelGrid& VoxelGrid::operator=(VoxelGrid&&) noexcept = default;
VoxelGrid::~VoxelGrid() = default;

absl::Status VoxelGrid::Add(const BrickBatch& batch) try {
  AddBricksAndTiles(batch.bricks, content_->grid->tree());
  return absl::OkStatus();
} catch (const std::bad_alloc&) {
  return NoMemoryForVoxels();
}

void VoxelGrid::SetRequest(const VoxelizeRequest& request, const MeshNote& note) {
  InsertMetadata(RequestMetadata(request, note), *content_->grid);
}

void VoxelGrid::SetCertificate(const Certificate& certificate) {
  InsertMetadata(CertificateMetadata(certificate), *content_->grid);
}

void VoxelGrid::SetWarnings(const std::vector<Warning>& warnings) {
  InsertMetadata(WarningMetadata(warnings), *content_->grid);
}

void VoxelGrid::SetMetadata(const std::vector<std::pair<std::string, std::string>>& metadata) {
  InsertMetadata(TypedMetadata(metadata), *content_->grid);
}

uint64_t VoxelGrid::CountActiveVoxels() const { return content_->grid->activeVoxelCount(); }

absl::Status VoxelGrid::Write(const std::string& path, const Cancellation& cancellation) const try {
  openvdb::tools::prune(content_->grid->tree());
  return WriteGridFile({content_->grid}, path, {}, cancellation);
} catch (const std::bad_alloc&) {
  return NoMemoryForVoxels();
}

absl::Status VoxelGrid::WriteNano(const std::string& path, const Cancellation& cancellation) const try {
  openvdb::tools::prune(content_->grid->tree());
  return WriteNanoFile({content_->grid}, path, {}, cancellation);
} catch (const std::bad_alloc&) {
  return NoMemoryForVoxels();
}

absl::StatusOr<GridFileInfo> ReadGridFileInfo(std::istream& in, const std::string& path) {
  return WithArchive(in, path, [&](GridArchive& archive) -> absl::StatusOr<GridFileInfo> {
    const auto name = SetName(archive, path);
    if (!name.ok()) return name.status();
    const openvdb::GridBase::Ptr grid = archive.ReadGrid(*name);
    if (!grid->transform().isLinear()) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": the grid's transform is not affine"));
    }
    return Describe(*grid);
  });
}

absl::StatusOr<GridFileInfo> ReadGridFileInfo(const std::string& path) {
  auto file = OpenGridFile(path);
  if (!file.ok()) return file.status();
  return ReadGridFileInfo(*file, path);
}

absl::StatusOr<GridFile> ReadVoxels(GridArchive& archive, const std::string& path) {
  const auto name = SetName(archive, path);
  if (!name.ok()) return name.status();
  return Content(archive.ReadGrid(*name), path);
}

absl::StatusOr<GridFile> ReadGridFile(const std::string& path) {
  return WithFile(path, [&](GridArchive& archive) { return ReadVoxels(archive, path); });
}

}  // namespace latvox::client
