#include "latvox/grid/distance_grid.h"

#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>

#include "absl/strings/str_cat.h"
#include "client/grid/band_grid.h"
#include "client/grid/field_forms.h"
#include "client/grid/grid_file.h"
#include "client/grid/grid_metadata.h"
#include "client/grid/metadata_types.h"
#include "client/grid/nano_file.h"
#include "client/grid/openvdb_metadata.h"
#include "client/grid/openvdb_trees.h"
#include "client/grid/request_metadata.h"
#include "client/grid/warning_metadata.h"

namespace latvox::client {
namespace {

// Where a step along an axis crosses the surface, both its ends are no farther from it than the step is long. So a band
// that is wider has a sign on each side of every voxel beyond it.
bool SeparatesSides(const Basis& basis, double width) {
  const auto length = [](const Vec3d& v) { return std::hypot(v[0], v[1], v[2]); };
  return width >= std::max({length(basis.a), length(basis.b), length(basis.c)});
}

}  // namespace

openvdb::FloatGrid::Ptr NewBandGrid(const Basis& basis, double width, bool is_signed, bool whole) {
  openvdb::initialize();
  const auto grid = openvdb::FloatGrid::create(static_cast<float>(width));
  grid->setName(NameOf(Field::kDistance));
  if (is_signed && whole && SeparatesSides(basis, width)) grid->setGridClass(openvdb::GRID_LEVEL_SET);
  return grid;
}

void FillInside(openvdb::FloatGrid& grid) {
  if (grid.getGridClass() == openvdb::GRID_LEVEL_SET) openvdb::tools::signedFloodFill(grid.tree());
}

struct DistanceGrid::Content {
  openvdb::FloatGrid::Ptr grid;
};

DistanceGrid::DistanceGrid(const GridTransform& transform, double width, bool is_signed, bool whole)
    : content_(std::make_unique<Content>(Content{NewBandGrid(transform.basis, width, is_signed, whole)})) {
  Place(transform, *content_->grid);
}

DistanceGrid::DistanceGrid(DistanceGrid&&) noexcept = default;
DistanceGrid& DistanceGrid::operator=(DistanceGrid&&) noexcept = default;
DistanceGrid::~DistanceGrid() = default;

absl::Status DistanceGrid::Add(const BrickBatch& batch) try {
  FillFieldGrid(batch.bricks, *FindField(batch.fields, Field::kDistance), *content_->grid);
  return absl::OkStatus();
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError("not enough memory for the OpenVDB grid");
}

void DistanceGrid::SetRequest(const VoxelizeRequest& request, const MeshNote& note) {
  InsertMetadata(RequestMetadata(request, note), *content_->grid);
}

void DistanceGrid::SetCertificate(const Certificate& certificate) {
  InsertMetadata(CertificateMetadata(certificate), *content_->grid);
}

void DistanceGrid::SetWarnings(const std::vector<Warning>& warnings) {
  InsertMetadata(WarningMetadata(warnings), *content_->grid);
}

void DistanceGrid::SetMetadata(const std::vector<std::pair<std::string, std::string>>& metadata) {
  InsertMetadata(TypedMetadata(metadata), *content_->grid);
}

namespace {

// Fills the inside, then calls write(grids).
template <class Write>
absl::Status WriteFilled(const openvdb::FloatGrid::Ptr& grid, const std::string& path, const Write& write) try {
  FillInside(*grid);
  return write(openvdb::GridCPtrVec{grid});
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError(absl::StrCat(path, ": not enough memory to fill the inside"));
} catch (const std::exception& error) {
  return absl::UnknownError(absl::StrCat(path, ": the inside cannot be filled (", error.what(), ")"));
}

}  // namespace

absl::Status DistanceGrid::Write(const std::string& path, const Cancellation& cancellation) {
  const auto write = [&](const auto& grids) { return WriteGridFile(grids, path, {}, cancellation); };
  return WriteFilled(content_->grid, path, write);
}

absl::Status DistanceGrid::WriteNano(const std::string& path, const Cancellation& cancellation) {
  const auto write = [&](const auto& grids) { return WriteNanoFile(grids, path, {}, cancellation); };
  return WriteFilled(content_->grid, path, write);
}

}  // namespace latvox::client
