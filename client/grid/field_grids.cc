#include "latvox/grid/field_grids.h"

#include <new>
#include <span>
#include <utility>

#include "client/grid/fill_grid.h"
#include "client/grid/grid_file.h"
#include "client/grid/grid_metadata.h"
#include "client/grid/names_metadata.h"
#include "client/grid/openvdb_trees.h"
#include "client/grid/request_metadata.h"
#include "client/grid/warning_metadata.h"
#include "latvox/grid/openvdb_grid.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

// The grid of a field, and the conversion of a voxel's components to its value.
struct IntegerForm {
  using Grid = openvdb::Int32Grid;
  static Grid::Ptr New() { return Grid::create(-1); }
  static int32_t ToValue(const uint32_t* number) { return static_cast<int32_t>(*number); }
};

struct SmallIntegerForm : IntegerForm {
  static int32_t ToValue(const uint16_t* number) { return *number; }
};

struct FloatForm {
  using Grid = openvdb::FloatGrid;
  static Grid::Ptr New() { return Grid::create(); }
  static float ToValue(const float* number) { return *number; }
};

struct ColorForm {
  using Grid = openvdb::Vec3SGrid;
  static Grid::Ptr New() { return Grid::create(); }
  static openvdb::Vec3s ToValue(const uint8_t* rgb) {
    const auto part = [rgb](size_t n) { return static_cast<float>(rgb[n]) / 255; };
    return {part(0), part(1), part(2)};
  }
};

struct PointForm : ColorForm {
  static openvdb::Vec3s ToValue(const float* weights) { return {weights[0], weights[1], 0}; }
};

struct VectorForm : ColorForm {
  static openvdb::Vec3s ToValue(const float* vector) { return {vector[0], vector[1], vector[2]}; }
};

// Calls visit(form) with the form of the field.
template <class Visit>
auto WithForm(Field field, const Visit& visit) {
  switch (field) {
    case Field::kColor:
      return visit(ColorForm());
    case Field::kDistance:
      return visit(FloatForm());
    case Field::kPoint:
      return visit(PointForm());
    case Field::kNormal:
      return visit(VectorForm());
    case Field::kFraction:
      return visit(SmallIntegerForm());
    case Field::kPart:
    case Field::kMaterial:
    case Field::kTriangle:
    case Field::kLinks:  // no grid holds these three, which have a number for each neighbor
    case Field::kLinkTriangles:
    case Field::kLinkCrossings:
      break;
  }
  return visit(IntegerForm());
}

openvdb::GridBase::Ptr NewGrid(const GridTransform& transform, Field field) {
  const auto grid = WithForm(field, [](auto form) -> openvdb::GridBase::Ptr { return form.New(); });
  grid->setName(NameOf(field));
  Place(transform, *grid);
  return grid;
}

template <class Form, class Value, class Number>
void Fill(std::span<const Brick> bricks, const FieldValues& values, Value (*to_value)(const Number*),
          openvdb::GridBase& grid) {
  FillGrid(bricks, values.As<Number>().data(), values.components(), to_value, static_cast<typename Form::Grid&>(grid));
}

}  // namespace

struct FieldGrids::Content {
  VoxelGrid voxels;
  std::vector<Field> fields;
  std::vector<openvdb::GridBase::Ptr> grids;  // of the fields
};

FieldGrids::FieldGrids(const GridTransform& transform, const std::vector<Field>& fields)
    : content_(std::make_unique<Content>(Content{VoxelGrid(transform), fields, {}})) {
  for (const Field field : fields) content_->grids.push_back(NewGrid(transform, field));
}

FieldGrids::FieldGrids(FieldGrids&&) noexcept = default;
FieldGrids& FieldGrids::operator=(FieldGrids&&) noexcept = default;
FieldGrids::~FieldGrids() = default;

absl::Status FieldGrids::Add(const BrickBatch& batch) try {
  for (size_t n = 0; n < content_->fields.size(); ++n) {
    WithForm(content_->fields[n], [&](auto form) {
      Fill<decltype(form)>(batch.bricks, batch.fields[n], &decltype(form)::ToValue, *content_->grids[n]);
    });
  }
  return content_->voxels.Add(batch);
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError("not enough memory for the OpenVDB grids");
}

void FieldGrids::SetRequest(const VoxelizeRequest& request, const MeshNote& note) {
  content_->voxels.SetRequest(request, note);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) DescribeRequest(request, note, *grid);
}

void FieldGrids::SetNames(const CarriedNames& names) {
  for (const Field field : content_->fields) {
    DescribeNames(names, field, *content_->voxels.content().grid);
    for (const openvdb::GridBase::Ptr& grid : content_->grids) DescribeNames(names, field, *grid);
  }
}

void FieldGrids::SetCertificate(const Certificate& certificate) {
  content_->voxels.SetCertificate(certificate);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) Describe(certificate, *grid);
}

void FieldGrids::SetWarnings(const std::vector<Warning>& warnings) {
  content_->voxels.SetWarnings(warnings);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) DescribeWarnings(warnings, *grid);
}

absl::Status FieldGrids::Write(const std::string& path) {
  openvdb::GridCPtrVec grids{content_->voxels.content().grid};
  grids.insert(grids.end(), content_->grids.begin(), content_->grids.end());
  return WriteGridFile(grids, path);
}

}  // namespace latvox::client
