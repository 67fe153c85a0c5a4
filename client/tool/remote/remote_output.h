// Voxels to an object on another machine.
#ifndef LATVOX_CLIENT_TOOL_REMOTE_REMOTE_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_REMOTE_REMOTE_OUTPUT_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/tool/output/output.h"
#include "client/tool/remote/object_transfer.h"

namespace latvox::client {

// Writes a local file first, because most formats go back in it. Finish sends the parts of a large file. Commit makes
// the object, and removes the local file.
class RemoteOutput : public Output {
 public:
  // All except the file's output must outlive the object.
  //   file    writes the local file `path`
  //   notes   for the object; read by Finish, so that they may be about the voxels
  //   bytes   receives the length of the object
  RemoteOutput(std::unique_ptr<Output> file, std::string path, const RemoteName& remote, const TransferOptions& options,
               std::function<ObjectNotes(const Summary&)> notes, uint64_t& bytes);

  void SetNames(const CarriedNames& names) override { file_->SetNames(names); }
  absl::Status Begin(const Accepted& accepted) override { return Named(file_->Begin(accepted)); }
  absl::Status Add(const BrickBatch& batch) override { return Named(file_->Add(batch)); }
  std::vector<Warning> Warnings() const override;  // with the name of the object
  absl::Status Finish(const Summary& summary) override;
  absl::Status Commit() override;

 private:
  absl::Status Named(const absl::Status& status) const;

  std::unique_ptr<Output> file_;
  const std::string path_;
  const RemoteName& remote_;
  const TransferOptions& options_;
  const std::function<ObjectNotes(const Summary&)> notes_;
  uint64_t& bytes_;
  std::unique_ptr<Upload> upload_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_REMOTE_REMOTE_OUTPUT_H_
