// The fields that voxels can carry, and the list of a request's fields.
#ifndef LATVOX_CORE_REQUEST_FIELDS_H_
#define LATVOX_CORE_REQUEST_FIELDS_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <span>

#include "core/lattice/frame.h"

namespace latvox {

enum class Field : uint32_t {
  kPart,
  kMaterial,
  kColor,
  kDistance,
  kTriangle,
  kPoint,
  kNormal,
  kLinks,
  kLinkTriangles,
  kLinkCrossings,
  kFraction,
  kLabelFractions
};

// The types of a field's components, on the wire and in memory.
enum class NumberType { kUint8, kUint16, kUint32, kFloat32 };

constexpr size_t BytesOf(NumberType type) {
  return type == NumberType::kUint8 ? 1 : type == NumberType::kUint16 ? 2 : 4;
}

// The most neighbors of a lattice point, of all lattices.
inline constexpr size_t kMostNeighbors = 2 * kMaxPairs;

// Numbers of components that depend on the job: one for each neighbor, in the order of core/fields/link_order.h, or one
// for each label whose fractions voxels carry.
inline constexpr uint32_t kOneForEachNeighbor = 0, kOneForEachLabel = std::numeric_limits<uint32_t>::max();

struct FieldFacts {
  Field field;
  const char* name;     // in the protocol, in files and on the command line
  NumberType type;      // of each component
  uint32_t components;  // of a voxel, or one of the constants above
  // A field of the mesh: the largest number of a vertex; the smallest is 0. Other fields have 0 here.
  uint32_t largest = 0;

  // The size of a voxel's value, if the voxel has so many neighbors, and fractions of so many labels.
  constexpr size_t bytes(size_t neighbors, size_t labels) const {
    return BytesOf(type) * (is_of_links() ? neighbors : components == kOneForEachLabel ? labels : components);
  }
  // Whether it says where the links to a voxel's neighbors meet the mesh.
  constexpr bool is_of_links() const { return components == kOneForEachNeighbor; }
  // Whether it says how much of a voxel's cell is inside.
  constexpr bool is_of_cell() const { return field == Field::kFraction || field == Field::kLabelFractions; }
  // Whether it comes from the triangle that is nearest to a voxel.
  constexpr bool is_of_nearest() const { return !is_of_links() && !is_of_cell(); }
  // Whether each vertex of the mesh has a number for it. A color's number is red << 16 | green << 8 | blue.
  constexpr bool is_of_mesh() const { return largest != 0; }
};

// All fields. A new field is one more row.
inline constexpr std::array<FieldFacts, 12> kFields{{
    {Field::kPart, "part", NumberType::kUint32, 1, 0x7FFFFFFF},
    {Field::kMaterial, "material", NumberType::kUint32, 1, 0x7FFFFFFF},
    {Field::kColor, "color", NumberType::kUint8, 3, 0xFFFFFF},
    {Field::kDistance, "distance", NumberType::kFloat32, 1},
    {Field::kTriangle, "triangle", NumberType::kUint32, 1},
    {Field::kPoint, "point", NumberType::kFloat32, 2},
    {Field::kNormal, "normal", NumberType::kFloat32, 3},
    {Field::kLinks, "links", NumberType::kFloat32, kOneForEachNeighbor},
    {Field::kLinkTriangles, "link_triangles", NumberType::kUint32, kOneForEachNeighbor},
    {Field::kLinkCrossings, "link_crossings", NumberType::kUint32, kOneForEachNeighbor},
    {Field::kFraction, "fraction", NumberType::kUint16, 1},
    {Field::kLabelFractions, "label_fractions", NumberType::kUint16, kOneForEachLabel},
}};

constexpr const FieldFacts& FactsOf(Field field) { return kFields[static_cast<size_t>(field)]; }
constexpr const char* NameOf(Field field) { return FactsOf(field).name; }

static_assert(std::ranges::all_of(kFields, [](const FieldFacts& row) { return &FactsOf(row.field) == &row; }),
              "each row stands at its field's number");

// Fields of a mesh.
inline constexpr size_t kMostMeshFields = static_cast<size_t>(std::ranges::count_if(kFields, &FieldFacts::is_of_mesh));

// The most labels whose fractions a voxel carries.
inline constexpr size_t kMostFractionLabels = 32;

// The most bytes that one voxel carries for one field, and for all.
inline constexpr size_t kMostFieldBytes = [] {
  size_t most = 0;
  for (const FieldFacts& row : kFields) most = std::max(most, row.bytes(kMostNeighbors, kMostFractionLabels));
  return most;
}();
inline constexpr size_t kMostBytesOfVoxel = [] {
  size_t sum = 0;
  for (const FieldFacts& row : kFields) sum += row.bytes(kMostNeighbors, kMostFractionLabels);
  return sum;
}();

// The share and the triangle of a link that the mesh does not cross.
inline constexpr float kNotCrossed = std::numeric_limits<float>::quiet_NaN();
inline constexpr uint32_t kNoTriangle = std::numeric_limits<uint32_t>::max();

// A fraction is the number of points of a lattice that is this many times as fine.
inline constexpr uint32_t kLeastFraction = 2, kMostFraction = 16;

// A list of fields, in the order of the request. It is plain bytes, because a decoder process receives it.
class FieldList {
 public:
  constexpr FieldList() = default;
  // Precondition: no field occurs twice.
  constexpr FieldList(std::initializer_list<Field> fields) {
    for (const Field field : fields) Add(field);
  }

  // Precondition: the field is not in the list.
  constexpr void Add(Field field) { fields_[count_++] = field; }
  constexpr bool Contains(Field field) const { return std::ranges::find(view(), field) != view().end(); }

  // The fields of the mesh among these, in this order.
  constexpr FieldList OfMesh() const {
    FieldList fields;
    for (const Field field : view()) {
      if (FactsOf(field).is_of_mesh()) fields.Add(field);
    }
    return fields;
  }

  // The fields that come from the nearest triangle, or of links, or of cells, among these, in this order.
  constexpr FieldList OfNearest() const { return Those(&FieldFacts::is_of_nearest); }
  constexpr FieldList OfLinks() const { return Those(&FieldFacts::is_of_links); }
  constexpr FieldList OfCells() const { return Those(&FieldFacts::is_of_cell); }

  // The size of a voxel's values, if the voxel has so many neighbors, and fractions of so many labels.
  constexpr size_t bytes(size_t neighbors, size_t labels) const {
    size_t sum = 0;
    for (const Field field : view()) sum += FactsOf(field).bytes(neighbors, labels);
    return sum;
  }

  constexpr uint32_t size() const { return count_; }
  constexpr bool empty() const { return count_ == 0; }
  constexpr std::span<const Field> view() const { return std::span(fields_).first(count_); }
  constexpr auto begin() const { return view().begin(); }
  constexpr auto end() const { return view().end(); }

  bool operator==(const FieldList&) const = default;

 private:
  constexpr FieldList Those(bool (FieldFacts::*are)() const) const {
    FieldList fields;
    for (const Field field : view()) {
      if ((FactsOf(field).*are)()) fields.Add(field);
    }
    return fields;
  }

  uint32_t count_ = 0;
  std::array<Field, kFields.size()> fields_{};
};

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_FIELDS_H_
