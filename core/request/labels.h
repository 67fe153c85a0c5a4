// The labels of a request for a labeled set.
#ifndef LATVOX_CORE_REQUEST_LABELS_H_
#define LATVOX_CORE_REQUEST_LABELS_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/request/fields.h"

namespace latvox {

// Each number of a field of the mesh has its own set. A point of several sets has the number of the highest priority.
struct LabelRequest {
  Field field;                         // kPart or kMaterial
  std::span<const uint32_t> priority;  // from the highest down; then all other numbers, larger ones first
  const char* name;                    // of the request's field that names the field
  size_t most;                         // labels
};

// The most labels that an enclosed set can have. Each takes a walk.
inline constexpr size_t kMaxWalkLabels = 1 << 12;

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_LABELS_H_
