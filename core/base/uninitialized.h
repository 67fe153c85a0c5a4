// Large arrays that threads fill. A std::vector would first write zeros to all of it, from one thread.
#ifndef LATVOX_CORE_BASE_UNINITIALIZED_H_
#define LATVOX_CORE_BASE_UNINITIALIZED_H_

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/huge_pages.h"

namespace latvox {

// Like std::allocator, except that elements without a value stay indeterminate, and that large arrays consist of whole
// large pages, where the system has them.
template <class T>
struct UninitializedAllocator : std::allocator<T> {
  static_assert(std::is_trivially_default_constructible_v<T>);
  template <class U>
  struct rebind {
    using other = UninitializedAllocator<U>;
  };
  T* allocate(size_t count) {
    if (!IsLarge(count)) return std::allocator<T>::allocate(count);
    return static_cast<T*>(AllocatePages(count * sizeof(T)));
  }
  void deallocate(T* at, size_t count) {
    if (!IsLarge(count)) return std::allocator<T>::deallocate(at, count);
    FreePages(at, count * sizeof(T));
  }
  void construct(T* at) { ::new (static_cast<void*>(at)) T; }
  template <class... Args>
  void construct(T* at, Args&&... args) {
    std::construct_at(at, std::forward<Args>(args)...);
  }

  // Returns the memory of an array with so many elements.
  static size_t BytesOf(size_t count) { return IsLarge(count) ? WholePages(count * sizeof(T)) : count * sizeof(T); }

 private:
  static bool IsLarge(size_t count) { return count > kHugePage / sizeof(T); }
};

// resize() leaves new elements indeterminate.
template <class T>
using UninitializedVector = std::vector<T, UninitializedAllocator<T>>;

// The same, with memory for one more element behind the last, which kernels may read but not use.
template <class T>
struct PaddedAllocator : UninitializedAllocator<T> {
  template <class U>
  struct rebind {
    using other = PaddedAllocator<U>;
  };
  T* allocate(size_t count) { return UninitializedAllocator<T>::allocate(count + 1); }
  void deallocate(T* at, size_t count) { UninitializedAllocator<T>::deallocate(at, count + 1); }
  static size_t BytesOf(size_t count) { return UninitializedAllocator<T>::BytesOf(count + 1); }
};

template <class T>
using PaddedVector = std::vector<T, PaddedAllocator<T>>;

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_UNINITIALIZED_H_
