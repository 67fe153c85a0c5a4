// Arrays of HDF5 that grow by rows.
#ifndef LATVOX_CLIENT_TOOL_HDF5_HDF5_ROWS_H_
#define LATVOX_CLIENT_TOOL_HDF5_HDF5_ROWS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "client/tool/hdf5/hdf5_library.h"

namespace latvox::client {

// The name and form of an array.
struct Hdf5Form {
  std::string name;
  hid_t type;           // of an element
  size_t type_bytes;    // its size
  size_t columns;       // of a row
  bool is_flat = true;  // with one column, the array has one dimension instead of two
};

// A data set of an unlimited number of rows. It is chunked and compressed: shuffle, then deflate. Memory: a chunk,
// which has 65536 rows. Not thread-safe. An error of the library stays: later calls return it.
class Hdf5Rows {
 public:
  Hdf5Rows(const Hdf5& hdf5, hid_t place, const Hdf5Form& form);

  // Appends whole rows.
  void Append(const void* rows, size_t bytes);
  template <class T>
  void Append(const T& row) {
    Append(&row, sizeof(row));
  }

  // Writes what is left. Returns whether all calls have succeeded.
  bool Finish();

  uint64_t rows() const { return written_ + waiting_.size() / row_bytes_; }

 private:
  void Write();

  const Hdf5* hdf5_;
  hid_t type_;
  size_t row_bytes_, columns_;
  bool is_flat_;
  Hdf5Id set_;
  bool good_;
  std::string waiting_;
  uint64_t written_ = 0;  // rows
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_HDF5_HDF5_ROWS_H_
