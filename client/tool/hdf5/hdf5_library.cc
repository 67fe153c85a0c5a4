#include "client/tool/hdf5/hdf5_library.h"

#include <dlfcn.h>

#include <string>

#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

absl::StatusOr<const Hdf5*> LoadOnce() {
  const auto missing = [](const char* why) {
    return absl::FailedPreconditionError(
        absl::StrCat(LATVOX_HDF5_LIBRARY, ": HDF5's library cannot be loaded (", why,
                     "); other formats need none (Debian 12: libhdf5-103-1, Debian 13: libhdf5-310)"));
  };
  void* const handle = dlopen(LATVOX_HDF5_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) return missing(dlerror());
  static Hdf5 hdf5;
// Since HDF5 1.12, H5Literate is a macro: the name in the library is H5Literate2.
#define LATVOX_TEXT(name) #name
#define LATVOX_FIND(name)                                                              \
  hdf5.name = reinterpret_cast<decltype(hdf5.name)>(dlsym(handle, LATVOX_TEXT(name))); \
  if (hdf5.name == nullptr) return missing(LATVOX_TEXT(name));
  LATVOX_HDF5_FUNCTIONS(LATVOX_FIND)
#undef LATVOX_FIND
#undef LATVOX_TEXT
  // At the end of the process, it would write files that a failed call has left.
  if (hdf5.H5dont_atexit() < 0 || hdf5.H5open() < 0) return missing("it does not start");
  // Several files are written at once.
  hbool_t is_threadsafe = false;
  if (hdf5.H5is_library_threadsafe(&is_threadsafe) < 0 || !is_threadsafe) return missing("it is not thread-safe");
  // Filters of files could otherwise load libraries.
  if (hdf5.H5PLset_loading_state(0) < 0) return missing("H5PLset_loading_state");
#define LATVOX_FIND(name)                                                             \
  const auto* const name##_at = static_cast<const hid_t*>(dlsym(handle, #name "_g")); \
  if (name##_at == nullptr) return missing(#name);                                    \
  hdf5.name##_g = *name##_at;
  LATVOX_HDF5_IDS(LATVOX_FIND)
#undef LATVOX_FIND
  return &hdf5;
}

}  // namespace

absl::StatusOr<const Hdf5*> Hdf5::Load() {
  static const auto* const kLoaded = new absl::StatusOr<const Hdf5*>(LoadOnce());
  if (kLoaded->ok()) (**kLoaded)->SilenceThread();
  return *kLoaded;
}

}  // namespace latvox::client
