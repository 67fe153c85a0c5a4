// The encoded mesh while it arrives in pieces.
#ifndef LATVOX_SERVER_WORK_MESH_UPLOAD_H_
#define LATVOX_SERVER_WORK_MESH_UPLOAD_H_

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/cord.h"

namespace latvox {

class MeshUpload {
 public:
  // At the arrival of the specification. `declared` is the length that the client announced, 0 if none; `limit` the
  // most that is taken.
  MeshUpload(uint64_t declared, uint64_t limit) : declared_(declared), limit_(limit) {}

  // Takes the next piece over. Cheap enough for a gRPC callback: pieces are kept, not copied, unless they are small.
  // Errors: RESOURCE_EXHAUSTED over the limit, INVALID_ARGUMENT over the declared length.
  absl::Status Append(std::string&& piece);

  // INVALID_ARGUMENT if less than the declared length, or nothing at all, has come.
  absl::Status CheckComplete() const;

  // All bytes. The pieces are handed over, not copied.
  absl::Cord Release() &&;

  uint64_t size() const { return size_; }

  // From the specification to the last piece; nothing if no byte has come.
  std::optional<double> milliseconds() const;

 private:
  uint64_t declared_, limit_, size_ = 0;
  std::vector<std::string> pieces_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_WORK_MESH_UPLOAD_H_
