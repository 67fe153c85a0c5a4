// What a voxel gets for a field, from the triangle that is nearest to it.
#ifndef LATVOX_CORE_FIELDS_FIELD_WRITER_H_
#define LATVOX_CORE_FIELDS_FIELD_WRITER_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/band/triangle_distance.h"
#include "core/base/vec.h"
#include "core/fields/plan.h"
#include "core/request/fields.h"

namespace latvox {

// The nearest triangle of a voxel. Members after `square` are only valid if FieldPlan::is_searched.
struct Nearest {
  Vec3i point;     // the voxel's lattice point, local, in units
  bool is_inside;  // valid if FieldPlan::is_signed
  double square;   // of the distance, in units: the least TriangleDistance::SquareTo
  // The first triangle with an area at the smallest distance; the first of all if none has an area.
  uint32_t triangle;
  const TriangleDistance* shape;  // of that triangle
  // For each field of the mesh: the smallest number among the nearest corners of all triangles at that distance.
  std::array<uint32_t, kMostMeshFields> numbers;
};

class FieldWriter {
 public:
  virtual ~FieldWriter() = default;

  // Appends the field of one voxel, little-endian.
  virtual void Append(const Nearest& nearest, std::vector<std::byte>& out) const = 0;
};

// Each is in a file of its own. The plan must outlive it.
std::unique_ptr<FieldWriter> NewMeshNumberWriter(const FieldPlan& plan, Field field);
std::unique_ptr<FieldWriter> NewDistanceWriter(const FieldPlan& plan, Field field);
std::unique_ptr<FieldWriter> NewTriangleWriter(const FieldPlan& plan, Field field);
std::unique_ptr<FieldWriter> NewPointWriter(const FieldPlan& plan, Field field);
std::unique_ptr<FieldWriter> NewNormalWriter(const FieldPlan& plan, Field field);

// The writer of a field of plan.nearest.
std::unique_ptr<FieldWriter> NewFieldWriter(const FieldPlan& plan, Field field);

}  // namespace latvox

#endif  // LATVOX_CORE_FIELDS_FIELD_WRITER_H_
