// Files of HDF5 through an open file descriptor.
#ifndef LATVOX_CLIENT_TOOL_HDF5_DESCRIPTOR_DRIVER_H_
#define LATVOX_CLIENT_TOOL_HDF5_DESCRIPTOR_DRIVER_H_

#include "client/tool/hdf5/hdf5_library.h"

namespace latvox::client {

// How HDF5 reaches a file.
struct DescriptorAccess {
  int fd = -1;           // stays open
  int* error = nullptr;  // errno of the first failed write, otherwise unchanged; null: nothing is written
};

// Returns the property list that opens a file of any name through the descriptor. It needs only pread and pwrite, so a
// process without rights can read. After a failed write, HDF5 goes on as if it had succeeded, because it cannot close a
// file that it cannot write. The caller looks at `error`. Invalid: out of memory.
Hdf5Id AccessBy(const Hdf5& hdf5, const DescriptorAccess& access);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_HDF5_DESCRIPTOR_DRIVER_H_
