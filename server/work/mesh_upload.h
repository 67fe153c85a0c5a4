// An encoded mesh that arrives in pieces.
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
  // Construct it when the specification arrives. `declared` is the length that the client announced, 0 if none; `limit`
  // is the maximum length.
  MeshUpload(uint64_t declared, uint64_t limit) : declared_(declared), limit_(limit) {}

  // Appends the next piece. Cheap enough for a gRPC callback: pieces are kept, and copied only if they are small.
  // Errors: RESOURCE_EXHAUSTED over the limit, INVALID_ARGUMENT over the declared length.
  absl::Status Append(std::string&& piece);

  // Returns INVALID_ARGUMENT if less than the declared length has come, or nothing at all.
  absl::Status CheckComplete() const;

  // Returns all bytes. It moves the pieces, without a copy.
  absl::Cord Release() &&;

  uint64_t size() const { return size_; }

  // Returns the time from the specification to the last piece; nothing if no byte has come.
  std::optional<double> milliseconds() const;

 private:
  uint64_t declared_, limit_, size_ = 0;
  std::vector<std::string> pieces_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point last_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_WORK_MESH_UPLOAD_H_
