// The identity of a .vdb file. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_FILE_UUID_H_
#define LATVOX_CLIENT_GRID_FILE_UUID_H_

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstddef>
#include <string>

namespace latvox::client {

// The header of a .vdb: magic number, four numbers of versions and offsets in 13 bytes, then the file's UUID as text.
inline constexpr size_t kUuidAt = 21, kUuidBytes = 36;

// OpenVDB gives each file a random UUID. Its readers compare it to tell other content, so the content's own hash does
// as well, and equal jobs make equal files.
class FileUuid {
 public:
  FileUuid() { XXH3_128bits_reset(&state_); }

  // Adds bytes behind the header, in the order of writing: the places of a grid once as zeros, and again behind it.
  void Add(const char* bytes, size_t size) { XXH3_128bits_update(&state_, bytes, size); }

  // Returns a UUID of version 8: 122 bits are free for everybody's own use.
  std::string Text() const;

 private:
  XXH3_state_t state_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_FILE_UUID_H_
