// Zip archives in memory.
#ifndef LATVOX_CLIENT_MESH_FILES_ZIP_ARCHIVE_H_
#define LATVOX_CLIENT_MESH_FILES_ZIP_ARCHIVE_H_

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

struct zip;

namespace latvox::client {

class ZipArchive {
 public:
  // `bytes` must outlive the archive. There may be other bytes before and after it, and local headers may disagree with
  // the directory, as those of streams do: the directory counts. All entries that are read may together unpack to
  // `max_bytes`. Errors: INVALID_ARGUMENT (not a zip archive).
  static absl::StatusOr<ZipArchive> Open(absl::string_view bytes, uint64_t max_bytes);

  // Returns the number of bytes before and after the archive.
  size_t foreign_bytes() const { return foreign_; }

  // Returns the bytes of the entry. Takes no more memory than the limit leaves, whatever the archive declares.
  // Errors: INVALID_ARGUMENT, with the name: there is no such entry, it is damaged or encrypted; RESOURCE_EXHAUSTED
  // with the limit.
  absl::StatusOr<std::string> Read(const std::string& name);

 private:
  struct Discard {
    void operator()(zip* archive) const;
  };

  std::unique_ptr<zip, Discard> archive_;
  size_t foreign_ = 0;
  uint64_t max_bytes_ = 0, left_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_ZIP_ARCHIVE_H_
