// An array that does not change any more, and what keeps its memory.
#ifndef LATVOX_CORE_BASE_SHARED_ARRAY_H_
#define LATVOX_CORE_BASE_SHARED_ARRAY_H_

#include <cstddef>
#include <memory>
#include <span>
#include <utility>

namespace latvox {

// Of what such a vector holds. Copies are of the same elements. What was moved from may only be assigned to, or
// destroyed.
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
  // What lies in memory that `memory` keeps, and that such a vector might have allocated.
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
