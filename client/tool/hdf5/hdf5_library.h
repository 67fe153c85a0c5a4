// HDF5's library, loaded when a call needs it.
#ifndef LATVOX_CLIENT_TOOL_HDF5_HDF5_LIBRARY_H_
#define LATVOX_CLIENT_TOOL_HDF5_HDF5_LIBRARY_H_

#include <hdf5.h>

#include <utility>

#include "absl/status/statusor.h"

namespace latvox::client {

// The functions that are used. A program that calls the library's own names would load it at its start.
// clang-format off
#define LATVOX_HDF5_FUNCTIONS(DO) \
  DO(H5is_library_threadsafe) \
  DO(H5open) DO(H5dont_atexit) DO(H5Eset_auto2) DO(H5PLset_loading_state) DO(H5FDregister) DO(H5Fcreate) \
  DO(H5Fopen) DO(H5Fclose) DO(H5Gcreate2) DO(H5Gopen2) DO(H5Gclose) DO(H5Lexists) DO(H5Dcreate2) DO(H5Dopen2) \
  DO(H5Dclose) DO(H5Dset_extent) DO(H5Dwrite) DO(H5Dread) DO(H5Dget_space) DO(H5Acreate2) DO(H5Aopen) \
  DO(H5Aclose) DO(H5Awrite) DO(H5Aread) DO(H5Aget_space) DO(H5Aget_type) DO(H5Aiterate2) DO(H5Literate) \
  DO(H5Screate) DO(H5Screate_simple) DO(H5Sclose) DO(H5Sselect_hyperslab) DO(H5Sget_simple_extent_ndims) \
  DO(H5Sget_simple_extent_dims) DO(H5Sget_simple_extent_npoints) DO(H5Tcopy) DO(H5Tclose) DO(H5Tset_size) \
  DO(H5Tset_cset) DO(H5Tget_class) DO(H5Tis_variable_str) DO(H5Pcreate) DO(H5Pclose) DO(H5Pset_chunk) \
  DO(H5Pset_deflate) DO(H5Pset_shuffle) DO(H5Pset_obj_track_times) DO(H5Pset_driver) DO(H5Pget_driver_info) \
  DO(H5free_memory)

// The types and property lists that are used.
#define LATVOX_HDF5_IDS(DO) \
  DO(H5T_STD_U8LE) DO(H5T_STD_U16LE) DO(H5T_STD_I32LE) DO(H5T_STD_U64LE) DO(H5T_IEEE_F32LE) DO(H5T_IEEE_F64LE) \
  DO(H5T_C_S1) DO(H5P_CLS_DATASET_CREATE_ID) DO(H5P_CLS_FILE_ACCESS_ID)
// clang-format on

// Members have the library's names. Types are H5T_STD_U8LE_g and so on.
struct Hdf5 {
  // Returns the library, which stays loaded. It prints no errors, and does nothing at the end of the process. Errors:
  // FAILED_PRECONDITION: it is not installed, not thread-safe, or another version. Thread-safe.
  static absl::StatusOr<const Hdf5*> Load();

  // Keeps the library from printing errors on this thread, as Load does: each thread has its own setting.
  void SilenceThread() const { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

#define LATVOX_MEMBER(name) decltype(&::name) name = nullptr;
  LATVOX_HDF5_FUNCTIONS(LATVOX_MEMBER)
#undef LATVOX_MEMBER
#define LATVOX_MEMBER(name) hid_t name##_g = H5I_INVALID_HID;
  LATVOX_HDF5_IDS(LATVOX_MEMBER)
#undef LATVOX_MEMBER
};

// An object of the library. Closes it at the end.
class Hdf5Id {
 public:
  using Close = herr_t (*)(hid_t);

  Hdf5Id() = default;
  Hdf5Id(hid_t id, Close close) : id_(id), close_(close) {}
  Hdf5Id(Hdf5Id&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Hdf5Id& operator=(Hdf5Id&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Hdf5Id() {
    if (ok()) close_(id_);
  }

  bool ok() const { return id_ >= 0; }
  hid_t get() const { return id_; }

 private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_HDF5_HDF5_LIBRARY_H_
