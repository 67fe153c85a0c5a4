#include "client/tool/remote/remote_output.h"

#include <filesystem>
#include <utility>

#include "absl/strings/str_replace.h"
#include "latvox/error.h"

namespace latvox::client {

RemoteOutput::RemoteOutput(std::unique_ptr<Output> file, std::string path, const RemoteName& remote,
                           const TransferOptions& options, std::function<ObjectNotes(const Summary&)> notes,
                           uint64_t& bytes)
    : file_(std::move(file)),
      path_(std::move(path)),
      remote_(remote),
      options_(options),
      notes_(std::move(notes)),
      bytes_(bytes) {}

absl::Status RemoteOutput::Named(const absl::Status& status) const {
  if (status.ok()) return status;
  absl::Status named(status.code(), absl::StrReplaceAll(status.message(), {{path_, remote_.name}}));
  ErrorDetails details = GetErrorDetails(status);
  if (details.value == path_) details.value = remote_.name;
  SetErrorDetails(details, named);
  return named;
}

std::vector<Warning> RemoteOutput::Warnings() const {
  std::vector<Warning> warnings = file_->Warnings();
  for (Warning& warning : warnings) {
    for (std::string* const text : {&warning.message, &warning.element}) {
      *text = absl::StrReplaceAll(*text, {{path_, remote_.name}});
    }
  }
  return warnings;
}

absl::Status RemoteOutput::Finish(const Summary& summary) {
  if (auto status = file_->Finish(summary); !status.ok()) return Named(status);
  if (auto status = file_->Commit(); !status.ok()) return Named(status);
  file_.reset();
  upload_ = std::make_unique<Upload>(remote_, options_, notes_(summary));
  return upload_->Begin(path_);
}

absl::Status RemoteOutput::Commit() {
  if (auto status = upload_->Finish(); !status.ok()) return status;
  bytes_ = upload_->bytes();
  upload_.reset();
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
  return absl::OkStatus();
}

}  // namespace latvox::client
