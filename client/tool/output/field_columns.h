// Fields as columns of tables and as arrays of numpy.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_FIELD_COLUMNS_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_FIELD_COLUMNS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "latvox/types.h"

namespace latvox::client {

struct FieldColumns {
  std::array<const char*, 3> names;  // one for each component; the rest are null
};

// In the order of kFields. A new field is one more row.
inline constexpr std::array<FieldColumns, kFields.size()> kFieldColumns{{{{"part"}},
                                                                         {{"material"}},
                                                                         {{"red", "green", "blue"}},
                                                                         {{"distance"}},
                                                                         {{"triangle"}},
                                                                         {{"u", "v"}},
                                                                         {{"nx", "ny", "nz"}}}};

// Returns the name of a component's column.
constexpr const char* ColumnOf(Field field, size_t component) {
  return kFieldColumns[static_cast<size_t>(field)].names[component];
}

// Returns the type of a component in numpy: "<i4", "u1" or "<f4". Numbers are below 2^31.
constexpr const char* NumpyTypeOf(Field field) {
  const NumberType type = FactsOf(field).type;
  return type == NumberType::kUint8 ? "u1" : type == NumberType::kUint32 ? "<i4" : "<f4";
}

// Returns the bytes of a voxel's field.
inline const char* BytesAt(const FieldValues& values, size_t voxel) {
  return reinterpret_cast<const char*>(&values.bytes[voxel * FactsOf(values.field).bytes()]);
}

// Appends the field of a voxel to other values of the same field.
inline void AppendVoxel(const FieldValues& from, size_t voxel, FieldValues& to) {
  const std::byte* const first = &from.bytes[voxel * FactsOf(from.field).bytes()];
  to.bytes.insert(to.bytes.end(), first, first + FactsOf(from.field).bytes());
}

// Returns the number of a voxel in a field of integers; of a color, red << 16 | green << 8 | blue.
inline uint32_t NumberAt(const FieldValues& values, size_t voxel) {
  if (FactsOf(values.field).type == NumberType::kUint32) return values.As<uint32_t>()[voxel];
  const uint8_t* const rgb = &values.As<uint8_t>()[3 * voxel];
  return uint32_t{rgb[0]} << 16 | uint32_t{rgb[1]} << 8 | rgb[2];
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_FIELD_COLUMNS_H_
