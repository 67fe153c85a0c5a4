#include "client/tool/hdf5/descriptor_driver.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>

namespace latvox::client {
namespace {

constexpr herr_t kGood = 0, kBad = -1;

// The library sees the first member alone.
struct DescriptorFile {
  H5FD_t base;
  DescriptorAccess access;
  haddr_t allocated, end;  // of the addresses in use; of the file's bytes
};

DescriptorFile& Of(H5FD_t* file) { return *reinterpret_cast<DescriptorFile*>(file); }
const DescriptorFile& Of(const H5FD_t* file) { return *reinterpret_cast<const DescriptorFile*>(file); }

const Hdf5& Library() { return **Hdf5::Load(); }

H5FD_t* Open(const char*, unsigned, hid_t list, haddr_t) {
  const auto* const access = static_cast<const DescriptorAccess*>(Library().H5Pget_driver_info(list));
  if (access == nullptr) return nullptr;
  const off_t end = lseek(access->fd, 0, SEEK_END);
  if (end < 0) return nullptr;
  return &(new DescriptorFile{{}, *access, 0, static_cast<haddr_t>(end)})->base;
}

herr_t Close(H5FD_t* file) {
  delete &Of(file);
  return kGood;
}

int Compare(const H5FD_t* a, const H5FD_t* b) { return Of(a).access.fd - Of(b).access.fd; }

herr_t Query(const H5FD_t*, unsigned long* features) {
  *features = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE |
              H5FD_FEAT_AGGREGATE_SMALLDATA;
  return kGood;
}

haddr_t GetAllocated(const H5FD_t* file, H5FD_mem_t) { return Of(file).allocated; }

herr_t SetAllocated(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  Of(file).allocated = end;
  return kGood;
}

haddr_t GetEnd(const H5FD_t* file, H5FD_mem_t) { return Of(file).end; }

// Bytes behind the end are 0, as HDF5 expects.
herr_t Read(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t at, size_t size, void* to) {
  auto* rest = static_cast<char*>(to);
  while (size > 0) {
    const ssize_t got = pread(Of(base).access.fd, rest, size, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return kBad;
    if (got == 0) {
      std::memset(rest, 0, size);
      return kGood;
    }
    rest += got;
    at += static_cast<haddr_t>(got);
    size -= static_cast<size_t>(got);
  }
  return kGood;
}

herr_t Write(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t at, size_t size, const void* from) {
  DescriptorFile& file = Of(base);
  if (file.access.error == nullptr) return kBad;
  const auto* rest = static_cast<const char*>(from);
  while (size > 0 && *file.access.error == 0) {
    const ssize_t done = pwrite(file.access.fd, rest, size, static_cast<off_t>(at));
    if (done < 0 && errno != EINTR) *file.access.error = errno;
    if (done < 0) continue;
    rest += done;
    at += static_cast<haddr_t>(done);
    size -= static_cast<size_t>(done);
  }
  file.end = std::max(file.end, at + size);
  return kGood;
}

herr_t Truncate(H5FD_t* base, hid_t, hbool_t) {
  DescriptorFile& file = Of(base);
  if (file.access.error == nullptr || file.end == file.allocated) return kGood;
  if (*file.access.error == 0 && ftruncate(file.access.fd, static_cast<off_t>(file.allocated)) != 0) {
    *file.access.error = errno;
  }
  file.end = file.allocated;
  return kGood;
}

hid_t Register() {
  static H5FD_class_t driver = {};
#ifdef H5FD_CLASS_VERSION  // since HDF5 1.14
  driver.version = H5FD_CLASS_VERSION;
  driver.value = H5_VFD_RESERVED;  // the first one that is not the library's own
#endif
  driver.name = "latvox";
  driver.maxaddr = (haddr_t{1} << 62) - 1;
  driver.fc_degree = H5F_CLOSE_STRONG;
  driver.fapl_size = sizeof(DescriptorAccess);
  driver.open = Open;
  driver.close = Close;
  driver.cmp = Compare;
  driver.query = Query;
  driver.get_eoa = GetAllocated;
  driver.set_eoa = SetAllocated;
  driver.get_eof = GetEnd;
  driver.read = Read;
  driver.write = Write;
  driver.truncate = Truncate;
  constexpr H5FD_mem_t kTypes[] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(kTypes), std::end(kTypes), driver.fl_map);
  return Library().H5FDregister(&driver);
}

}  // namespace

Hdf5Id AccessBy(const Hdf5& hdf5, const DescriptorAccess& access) {
  static const hid_t kDriver = Register();
  Hdf5Id list(hdf5.H5Pcreate(hdf5.H5P_CLS_FILE_ACCESS_ID_g), hdf5.H5Pclose);
  if (!list.ok() || hdf5.H5Pset_driver(list.get(), kDriver, &access) < 0) return {};
  return list;
}

}  // namespace latvox::client
