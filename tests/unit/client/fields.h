// Values of fields from plain numbers.
#ifndef LATVOX_TESTS_UNIT_CLIENT_FIELDS_H_
#define LATVOX_TESTS_UNIT_CLIENT_FIELDS_H_

#include <cstring>
#include <vector>

#include "latvox/types.h"

namespace latvox::client {

// T: as FieldFacts::type says.
template <class T>
FieldValues ValuesOf(Field field, const std::vector<T>& numbers) {
  FieldValues values{field, {}};
  values.bytes.resize(numbers.size() * sizeof(T));
  std::memcpy(values.bytes.data(), numbers.data(), values.bytes.size());
  return values;
}

}  // namespace latvox::client

#endif  // LATVOX_TESTS_UNIT_CLIENT_FIELDS_H_
