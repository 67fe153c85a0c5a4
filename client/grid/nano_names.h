// Names that NanoVDB changed in OpenVDB 12, while its files stayed the same except for a digit of the magic numbers.
#ifndef LATVOX_CLIENT_GRID_NANO_NAMES_H_
#define LATVOX_CLIENT_GRID_NANO_NAMES_H_

#if __has_include(<nanovdb/io/IO.h>)  // since OpenVDB 12; the headers have no version that tells
#define LATVOX_NANOVDB_OF_OPENVDB_12 1
#include <nanovdb/io/IO.h>
#else
#define LATVOX_NANOVDB_OF_OPENVDB_12 0
#include <nanovdb/util/IO.h>
#endif

#include <cstdint>
#include <string>

namespace latvox::client {

// Whether it begins a file or a grid: "NanoVDB" and a digit, as text. Each version reads all digits.
inline bool IsNanoMagic(uint64_t magic) {
  constexpr uint64_t kName = 0x00424456'6f6e614e, kWithoutDigit = 0x00ffffff'ffffffff;
  return (magic & kWithoutDigit) == kName;
}

#if LATVOX_NANOVDB_OF_OPENVDB_12
using NanoFileHeader = nanovdb::io::FileHeader;
using NanoMetaData = nanovdb::io::FileMetaData;

inline uint64_t BlindBytes(const nanovdb::GridBlindMetaData& blind) { return blind.mValueCount; }
inline int64_t BlindOffset(const nanovdb::GridBlindMetaData& blind) { return blind.mDataOffset; }
inline void SetBlindBytes(nanovdb::GridBlindMetaData& blind, uint64_t bytes) {
  blind.mValueCount = bytes;
  blind.mValueSize = 1;
}

inline std::string NanoTypeName(nanovdb::GridType type) {
  char name[nanovdb::strlen<nanovdb::GridType>()];
  return nanovdb::toStr(name, type);
}
#else
using NanoFileHeader = nanovdb::io::Header;
using NanoMetaData = nanovdb::io::MetaData;

inline uint64_t BlindBytes(const nanovdb::GridBlindMetaData& blind) { return blind.mElementCount; }
inline int64_t BlindOffset(const nanovdb::GridBlindMetaData& blind) { return blind.mByteOffset; }
inline void SetBlindBytes(nanovdb::GridBlindMetaData& blind, uint64_t bytes) { blind.mElementCount = bytes; }

inline std::string NanoTypeName(nanovdb::GridType type) { return nanovdb::toStr(type); }
#endif

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_NANO_NAMES_H_
