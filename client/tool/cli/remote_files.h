// The files of a job that are on other machines.
#ifndef LATVOX_CLIENT_TOOL_CLI_REMOTE_FILES_H_
#define LATVOX_CLIENT_TOOL_CLI_REMOTE_FILES_H_

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/internal/process_directory.h"
#include "client/tool/cli/voxelize_command.h"
#include "client/tool/cli/voxelize_options.h"
#include "client/tool/output/atomic_file.h"
#include "client/tool/remote/object_transfer.h"

namespace latvox::client {

// Copies of remote meshes, and the way of outputs to other machines. The copies are in a directory below TMPDIR or
// /tmp, which the destructor removes; if the process is killed, the next one does. Without remote names, there is none.
// Everything that the job says has the names of the objects in place of those of the copies.
class RemoteFiles {
 public:
  // Fetches the meshes, after a look at the credentials and schemes of all objects. The options must outlive the
  // object; those of the call are copied. Errors: those of Fetch; FAILED_PRECONDITION: no directory; INVALID_ARGUMENT:
  // AWS_MAX_ATTEMPTS.
  static absl::StatusOr<std::unique_ptr<RemoteFiles>> Fetch(const VoxelizeOptions& options, const CallOptions& call);

  // The options with the paths of the copies as meshes, and the objects' names as outputs.
  const VoxelizeOptions& local() const { return local_; }

  // S3 keeps this digest of the job with each of its objects, and the digest of the voxels.
  void SetJobDigest(const std::string& digest) { job_digest_ = digest; }

  // Returns the digest of the voxels if all outputs are objects of S3 that were made by the job with this digest.
  // Errors: those of FactsOf.
  absl::StatusOr<std::optional<std::string>> FindDone(const std::string& job_digest);

  // Returns whether an output is known to be missing, or to be of another job or length. The other side does not tell
  // that of a URL that is signed for writing alone. Errors: those of FactsOf.
  absl::StatusOr<bool> IsMissing(const std::string& output, const std::string& job_digest, uint64_t bytes);

  // Opens an output, here or on another machine. It must not outlive this object. Errors: those of OpenOutput.
  absl::StatusOr<std::unique_ptr<Output>> Open(const std::string& output, const VoxelizeRequest& request);

  // Lets the job write to other machines, and speak of objects. The hooks must not outlive this object.
  void Hook(JobHooks& hooks);

  // Returns the text or status with the names of objects.
  std::string Named(const std::string& text) const;
  absl::Status Named(const absl::Status& status) const;
  void Name(VoxelizeReport& report) const;

  // Returns the length of a remote output that was written or found.
  uint64_t BytesOf(const std::string& output) const;

 private:
  RemoteFiles(const VoxelizeOptions& options, const CallOptions& call);
  absl::Status CheckAccess() const;
  absl::Status MakeDirectory();
  absl::Status FetchMeshes();
  std::string NextPath(const RemoteName& remote);
  // Returns the error with the object that its message names as its ErrorDetails.
  absl::Status WithObject(absl::Status status) const;
  // Returns what names the object.
  std::string FieldOf(const std::string& name) const;

  const VoxelizeOptions& options_;
  VoxelizeOptions local_;
  TransferOptions transfer_;
  std::string job_digest_;
  std::unique_ptr<ProcessDirectory> directory_;
  std::unique_ptr<TemporaryDirectoryMark> mark_;
  std::vector<std::pair<std::string, std::string>> copies_;  // path and name
  std::map<std::string, uint64_t> bytes_;                    // by name
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_REMOTE_FILES_H_
