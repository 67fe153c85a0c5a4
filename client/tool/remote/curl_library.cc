#include "client/tool/remote/curl_library.h"

#include <dlfcn.h>

#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

absl::StatusOr<const Curl*> LoadOnce() {
  const auto missing = [](const char* why) {
    return absl::FailedPreconditionError(
        absl::StrCat(LATVOX_CURL_LIBRARY, ": curl's library cannot be loaded (", why,
                     "); only URLs need it (Debian 12: libcurl4, Debian 13: libcurl4t64)"));
  };
  void* const handle = dlopen(LATVOX_CURL_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) return missing(dlerror());
  static Curl curl;
#define LATVOX_FIND(name)                                                  \
  curl.name = reinterpret_cast<decltype(curl.name)>(dlsym(handle, #name)); \
  if (curl.name == nullptr) return missing(#name);
  LATVOX_CURL_FUNCTIONS(LATVOX_FIND)
#undef LATVOX_FIND
  if (curl.curl_global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK) return missing("it does not start");
  return &curl;
}

}  // namespace

absl::StatusOr<const Curl*> Curl::Load() {
  static const auto* const kLoaded = new absl::StatusOr<const Curl*>(LoadOnce());
  return *kLoaded;
}

}  // namespace latvox::client
