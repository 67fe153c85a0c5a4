// Work that can be cut short.
#ifndef LATVOX_CORE_BASE_CANCELLED_H_
#define LATVOX_CORE_BASE_CANCELLED_H_

#include <atomic>

namespace latvox {

// The flag of work that nobody cancels. A function that takes such a flag returns soon once it is set, with a result
// that is of no use.
inline const std::atomic<bool> kNeverCancelled = false;

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_CANCELLED_H_
