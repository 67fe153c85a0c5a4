#include "client/grid/difference_file.h"

#include <iterator>
#include <new>

#include "client/grid/fill_grid.h"
#include "client/grid/grid_file.h"
#include "client/grid/names_metadata.h"
#include "client/grid/openvdb_metadata.h"
#include "client/grid/openvdb_trees.h"
#include "latvox/grid/openvdb_grid.h"

namespace latvox::client {
namespace {

// Sets name, place and the metadata about the comparison.
void DescribeDifference(const GridDifference& difference, const GridTransform& transform, const char* name,
                        openvdb::GridBase& grid) {
  grid.setName(name);
  Place(transform, grid);
  Metadata metadata = NamesMetadata({{std::begin(kDifferenceNames), std::end(kDifferenceNames)}, {}}, Field::kPart);
  metadata["latvox_difference_a"] = ToMetadata(difference.a);
  metadata["latvox_difference_b"] = ToMetadata(difference.b);
  InsertMetadata(metadata, grid);
}

}  // namespace

absl::Status WriteDifferenceFile(const GridDifference& difference, const GridTransform& transform,
                                 const std::string& path, const Cancellation& cancellation) try {
  VoxelGrid voxels(transform);
  if (auto status = voxels.Add({difference.bricks}); !status.ok()) return status;
  const auto part = openvdb::Int32Grid::create(-1);
  FillGrid(
      difference.bricks, difference.marks.data(), 1, [](const uint32_t* n) { return static_cast<int32_t>(*n); }, *part);
  DescribeDifference(difference, transform, "voxels", *voxels.content().grid);
  DescribeDifference(difference, transform, NameOf(Field::kPart), *part);
  openvdb::GridCPtrVec grids{voxels.content().grid, part};
  if (difference.has_distances) {
    const auto changes = openvdb::FloatGrid::create(0);
    FillGrid(
        difference.changed, difference.changes.data(), 1, [](const float* change) { return *change; }, *changes);
    DescribeDifference(difference, transform, "difference", *changes);
    grids.push_back(changes);
  }
  return WriteGridFile(grids, path, {}, cancellation);
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError("not enough memory for the OpenVDB grids");
}

}  // namespace latvox::client
