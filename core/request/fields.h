// The fields that voxels can carry, and the list of a request's fields.
//
// Each vertex of a mesh has one number for each field. A voxel carries the numbers of the nearest corner of the nearest
// triangle: see core/attributes/attribute_scan.h.
#ifndef LATVOX_CORE_REQUEST_FIELDS_H_
#define LATVOX_CORE_REQUEST_FIELDS_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

namespace latvox {

enum class Field : uint32_t { kPart, kMaterial, kColor };

struct FieldFacts {
  Field field;
  const char* name;  // in the protocol, in files and on the command line
  uint32_t largest;  // number of a vertex; the smallest is 0
};

// All fields. A new field is one more row.
inline constexpr std::array<FieldFacts, 3> kFields{{
    {Field::kPart, "part", 0x7FFFFFFF},
    {Field::kMaterial, "material", 0x7FFFFFFF},
    {Field::kColor, "color", 0xFFFFFF},  // red << 16 | green << 8 | blue
}};

constexpr const FieldFacts& FactsOf(Field field) { return kFields[static_cast<size_t>(field)]; }
constexpr const char* NameOf(Field field) { return FactsOf(field).name; }

static_assert(std::ranges::all_of(kFields, [](const FieldFacts& row) { return &FactsOf(row.field) == &row; }),
              "each row stands at its field's number");

// A list of fields, in the order in which a voxel carries their numbers. It is plain bytes, because a decoder process
// receives it.
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

  constexpr uint32_t size() const { return count_; }
  constexpr bool empty() const { return count_ == 0; }
  constexpr std::span<const Field> view() const { return std::span(fields_).first(count_); }
  constexpr auto begin() const { return view().begin(); }
  constexpr auto end() const { return view().end(); }

  bool operator==(const FieldList&) const = default;

 private:
  uint32_t count_ = 0;
  std::array<Field, kFields.size()> fields_{};
};

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_FIELDS_H_
