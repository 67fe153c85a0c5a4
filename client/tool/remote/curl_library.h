// curl's library, loaded when a call needs it.
#ifndef LATVOX_CLIENT_TOOL_REMOTE_CURL_LIBRARY_H_
#define LATVOX_CLIENT_TOOL_REMOTE_CURL_LIBRARY_H_

#define CURL_DISABLE_TYPECHECK  // its macros would hide the members below
#include <curl/curl.h>
#undef curl_easy_setopt
#undef curl_easy_getinfo

#include "absl/status/statusor.h"

namespace latvox::client {

// The functions that are used. A program that calls the library's own names would load it at its start.
// clang-format off
#define LATVOX_CURL_FUNCTIONS(DO) \
  DO(curl_global_init) DO(curl_easy_init) DO(curl_easy_reset) DO(curl_easy_setopt) DO(curl_easy_perform) \
  DO(curl_easy_getinfo) DO(curl_easy_cleanup) DO(curl_easy_strerror) DO(curl_slist_append) DO(curl_slist_free_all)
// clang-format on

// Members have the library's names.
struct Curl {
  // Returns the library, which stays loaded. Errors: FAILED_PRECONDITION: it is not installed, or cannot start.
  // Thread-safe.
  static absl::StatusOr<const Curl*> Load();

#define LATVOX_MEMBER(name) decltype(&::name) name = nullptr;
  LATVOX_CURL_FUNCTIONS(LATVOX_MEMBER)
#undef LATVOX_MEMBER
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_REMOTE_CURL_LIBRARY_H_
