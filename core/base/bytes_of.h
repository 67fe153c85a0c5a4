// The memory that arrays hold, whether used or not.
#ifndef LATVOX_CORE_BASE_BYTES_OF_H_
#define LATVOX_CORE_BASE_BYTES_OF_H_

#include <cstddef>
#include <vector>

namespace latvox {

template <class T, class Allocator>
size_t BytesOf(const std::vector<T, Allocator>& array) {
  return array.capacity() * sizeof(T);
}

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_BYTES_OF_H_
