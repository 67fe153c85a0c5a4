// Appends numbers as bytes.
#ifndef LATVOX_CORE_FIELDS_APPEND_H_
#define LATVOX_CORE_FIELDS_APPEND_H_

#include <bit>
#include <cstddef>
#include <type_traits>
#include <vector>

namespace latvox {

static_assert(std::endian::native == std::endian::little, "fields are sent as they lie in memory");

template <class T>
void AppendBytes(const T& numbers, std::vector<std::byte>& out) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto* const bytes = reinterpret_cast<const std::byte*>(&numbers);
  out.insert(out.end(), bytes, bytes + sizeof(T));
}

}  // namespace latvox

#endif  // LATVOX_CORE_FIELDS_APPEND_H_
