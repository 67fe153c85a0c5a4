// An array that does not change any more, with the owner of its memory.
#ifndef LATVOX_CORE_BASE_SHARED_ARRAY_H_
#define LATVOX_CORE_BASE_SHARED_ARRAY_H_

#include <cstddef>
#include <memory>
#include <span>
#include <utility>

namespace latvox {

// A view of such a vector's content. Copies share the same elements. An object that was moved from may only be assigned
// to, or destroyed.
template <class Vector>
class SharedArray {
 public:
  using T = typename Vector::value_type;

  SharedArray() = default;
  SharedArray(Vector elements) {
    const auto kept = std::make_shared<const Vector>(std::move(elements));
    memory_ = kept;
    elements_ = *kept;
  }
  // A view of elements in memory that `memory` keeps, as such a vector might have allocated them.
  SharedArray(std::shared_ptr<const void> memory, std::span<const T> elements)
      : memory_(std::move(memory)), elements_(elements) {}

  size_t size() const { return elements_.size(); }
  const T* data() const { return elements_.data(); }
  const T& operator[](size_t n) const { return elements_[n]; }
  auto begin() const { return elements_.begin(); }
  auto end() const { return elements_.end(); }

 private:
  std::shared_ptr<const void> memory_;
  std::span<const T> elements_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_SHARED_ARRAY_H_
