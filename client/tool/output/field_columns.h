// Fields as columns of tables and as arrays of numpy.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_FIELD_COLUMNS_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_FIELD_COLUMNS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "latvox/types.h"

namespace latvox::client {

struct FieldColumns {
  // One for each component; the rest are null. For links and labels, none: see LinkName and FractionName.
  std::array<const char*, 3> names;
};

// In the order of kFields. A new field is one more row.
inline constexpr std::array<FieldColumns, kFields.size()> kFieldColumns{{{{"part"}},
                                                                         {{"material"}},
                                                                         {{"red", "green", "blue"}},
                                                                         {{"distance"}},
                                                                         {{"triangle"}},
                                                                         {{"u", "v"}},
                                                                         {{"nx", "ny", "nz"}},
                                                                         {},
                                                                         {},
                                                                         {},
                                                                         {{"fraction"}},
                                                                         {}}};

// Returns the names of a field's columns. Those of links end in the neighbor's lattice vector: link_-1_0_1. Those of
// labels end in the label: fraction_7.
inline std::vector<std::string> ColumnsOf(Field field, const Accepted& accepted) {
  std::vector<std::string> columns;
  const auto& names = kFieldColumns[static_cast<size_t>(field)].names;
  if (FactsOf(field).is_of_links()) {
    for (const Vec3i& q : accepted.neighbors) columns.push_back(LinkName(field, q));
  } else if (FactsOf(field).is_of_labels()) {
    for (const uint32_t label : accepted.fraction_labels) columns.push_back(FractionName(label));
  } else {
    for (size_t n = 0; n < FactsOf(field).components; ++n) columns.emplace_back(names[n]);
  }
  return columns;
}

// Returns the type of a component in numpy: "<i4", "<u2", "|u1" or "<f4". Numbers are below 2^31, and -1 means that
// there is no triangle.
constexpr const char* NumpyTypeOf(NumberType type) {
  return type == NumberType::kUint8    ? "|u1"
         : type == NumberType::kUint16 ? "<u2"
         : type == NumberType::kUint32 ? "<i4"
                                       : "<f4";
}

// Returns the bytes of a voxel's field.
inline const char* BytesAt(const FieldValues& values, size_t voxel) {
  return reinterpret_cast<const char*>(&values.bytes[voxel * values.bytes_of_voxel()]);
}

// Appends the field of a voxel to other values of the same field.
inline void AppendVoxel(const FieldValues& from, size_t voxel, FieldValues& to) {
  const std::byte* const first = &from.bytes[voxel * from.bytes_of_voxel()];
  to.bytes.insert(to.bytes.end(), first, first + from.bytes_of_voxel());
}

// Returns the number of a voxel in a field of integers; of a color, red << 16 | green << 8 | blue.
inline uint32_t NumberAt(const FieldValues& values, size_t voxel) {
  if (FactsOf(values.field).type == NumberType::kUint32) return values.As<uint32_t>()[voxel];
  if (FactsOf(values.field).type == NumberType::kUint16) return values.As<uint16_t>()[voxel];
  const uint8_t* const rgb = &values.As<uint8_t>()[3 * voxel];
  return uint32_t{rgb[0]} << 16 | uint32_t{rgb[1]} << 8 | rgb[2];
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_FIELD_COLUMNS_H_
