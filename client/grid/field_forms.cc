#include "client/grid/field_forms.h"

#include <string>

#include "client/grid/fill_grid.h"

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
    case Field::kLabelFractions:
      return visit(SmallIntegerForm());
    case Field::kPart:
    case Field::kMaterial:
    case Field::kTriangle:
    case Field::kLinks:  // link_grids makes the grids of these three
    case Field::kLinkTriangles:
    case Field::kLinkCrossings:
      break;
  }
  return visit(IntegerForm());
}

template <class Form, class Value, class Number>
void Fill(std::span<const Brick> bricks, const FieldValues& values, size_t n, Value (*to_value)(const Number*),
          openvdb::GridBase& grid) {
  FillGrid(bricks, values.As<Number>().data() + n, values.components(), to_value,
           static_cast<typename Form::Grid&>(grid));
}

}  // namespace

std::vector<openvdb::GridBase::Ptr> NewFieldGrids(Field field, const std::vector<uint32_t>& fraction_labels) {
  std::vector<openvdb::GridBase::Ptr> grids;
  if (FactsOf(field).is_of_links()) return grids;
  const auto add = [&](const std::string& name) {
    grids.push_back(WithForm(field, [](auto form) -> openvdb::GridBase::Ptr { return form.New(); }));
    grids.back()->setName(name);
  };
  if (!FactsOf(field).is_of_labels()) {
    add(NameOf(field));
  } else {
    for (const uint32_t label : fraction_labels) add(FractionName(label));
  }
  return grids;
}

void FillFieldGrid(std::span<const Brick> bricks, const FieldValues& values, openvdb::GridBase& grid, size_t n) {
  WithForm(values.field, [&](auto form) { Fill<decltype(form)>(bricks, values, n, &decltype(form)::ToValue, grid); });
}

}  // namespace latvox::client
