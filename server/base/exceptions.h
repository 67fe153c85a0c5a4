// Turns exceptions of core and the standard library into statuses.
#ifndef LATVOX_SERVER_BASE_EXCEPTIONS_H_
#define LATVOX_SERVER_BASE_EXCEPTIONS_H_

#include <exception>
#include <new>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"

namespace latvox {

// Calls work(), which returns a Status or StatusOr. Containers may run out of memory at any point, and a task of the
// arena must not throw. Errors: those of `work`; RESOURCE_EXHAUSTED (memory); INTERNAL (any other exception).
template <class F>
auto WithoutExceptions(F&& work) -> decltype(work()) {
  try {
    return std::forward<F>(work)();
  } catch (const std::bad_alloc&) {
    return WithRetry(MakeError(absl::StatusCode::kResourceExhausted, "memory: the server has no more",
                               {"OUT_OF_MEMORY", "memory", "", ""}),
                     absl::Seconds(1));
  } catch (const std::exception& error) {
    return absl::InternalError(absl::StrCat("exception: ", error.what()));
  }
}

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_EXCEPTIONS_H_
