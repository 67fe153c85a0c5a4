// Objects to and from other machines, streamed and checked.
#ifndef LATVOX_CLIENT_TOOL_REMOTE_OBJECT_TRANSFER_H_
#define LATVOX_CLIENT_TOOL_REMOTE_OBJECT_TRANSFER_H_

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/tool/remote/http_call.h"
#include "client/tool/remote/remote_name.h"

namespace latvox::client {

// Small texts that S3 keeps with an object: names in lower case with letters, digits and -.
using ObjectNotes = std::map<std::string, std::string>;

struct ObjectFacts {
  uint64_t bytes = 0;
  ObjectNotes notes;
};

// Checks that the calls of an object can begin: its scheme is allowed, and s3 has credentials and an endpoint.
absl::Status CheckAccess(const RemoteName& remote, const TransferOptions& options);

// Writes the object to a new file. The bytes must have the length that the answer states. If the answer has a checksum,
// they must have that, too: SHA-256 (x-amz-checksum-sha256), or from S3 an ETag that is an MD5.
// Errors: those of Call; FAILED_PRECONDITION: the file cannot be written.
absl::Status Fetch(const RemoteName& remote, const std::string& path, const TransferOptions& options);

// Returns the facts of an object; nothing if there is none. Returns facts without notes and with `bytes` 0 if the other
// side does not tell: a URL is signed for another method, or S3 hides missing objects from callers that may not list
// the bucket. Errors: those of Call.
absl::StatusOr<std::optional<ObjectFacts>> FactsOf(const RemoteName& remote, const TransferOptions& options);

// Sends a file as an object. The object appears, or is replaced, only by Finish, and as a whole. Not thread-safe.
// Small files, and those of URLs, go by one PUT. Others go to S3 in parts, and the destructor takes them back if
// Finish did not succeed. If the process is killed, S3 keeps the parts until a rule of the bucket removes them.
class Upload {
 public:
  static constexpr uint64_t kPartBytes = uint64_t{8} << 20;

  // The options must outlive the object.
  Upload(RemoteName remote, const TransferOptions& options, ObjectNotes notes);
  ~Upload();
  Upload(const Upload&) = delete;
  Upload& operator=(const Upload&) = delete;

  // Opens the file, and sends the parts of a large one. Errors: those of Call; FAILED_PRECONDITION: the file cannot be
  // read, or has more than 10,000 parts of 5 GiB.
  absl::Status Begin(const std::string& path);

  // Makes the object. Precondition: Begin succeeded. Errors: those of Call.
  absl::Status Finish();

  uint64_t bytes() const { return bytes_; }

 private:
  absl::Status Start();
  absl::Status SendPart(int number, uint64_t offset, uint64_t bytes);
  absl::Status PutWhole();
  absl::Status Complete();
  absl::Status CheckCompleted();

  const RemoteName remote_;
  const TransferOptions& options_;
  const ObjectNotes notes_;
  int fd_ = -1;
  uint64_t bytes_ = 0;
  std::string upload_id_;           // of parts that are neither joined nor taken back
  std::vector<std::string> etags_;  // of the parts, as the answers have them
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_REMOTE_OBJECT_TRANSFER_H_
