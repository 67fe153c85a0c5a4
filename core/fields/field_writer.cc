#include "core/fields/field_writer.h"

namespace latvox {
namespace {

using NewWriter = std::unique_ptr<FieldWriter> (*)(const FieldPlan& plan, Field field);

// In the order of kFields.
constexpr std::array<NewWriter, kFields.size()> kWriters{
    NewMeshNumberWriter,  // part
    NewMeshNumberWriter,  // material
    NewMeshNumberWriter,  // color
    NewDistanceWriter,
    NewTriangleWriter,
    NewPointWriter,
    NewNormalWriter,
    nullptr,  // links: link_table.h
    nullptr,  // link_triangles
    nullptr,  // link_crossings
    nullptr,  // fraction: fraction_table.h
    nullptr,  // label_fractions
};

}  // namespace

std::unique_ptr<FieldWriter> NewFieldWriter(const FieldPlan& plan, Field field) {
  return kWriters[static_cast<size_t>(field)](plan, field);
}

}  // namespace latvox
