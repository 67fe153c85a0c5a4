#include "client/tool/cli/remote_files.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "client/internal/file_error.h"
#include "client/tool/remote/remote_output.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

constexpr char kJob[] = "latvox-job", kVoxels[] = "latvox-voxels";

}  // namespace

RemoteFiles::RemoteFiles(const VoxelizeOptions& options, const CallOptions& call)
    : options_(options), local_(options), transfer_{.call = call, .allow_http = options.remote.allow_http} {}

absl::StatusOr<std::unique_ptr<RemoteFiles>> RemoteFiles::Fetch(const VoxelizeOptions& options,
                                                                const CallOptions& call) {
  std::unique_ptr<RemoteFiles> files(new RemoteFiles(options, call));
  if (options.remote.objects.empty()) return files;
  const auto tries = ReadTries(ProcessVariable);
  if (!tries.ok()) return tries.status();
  files->transfer_.tries = *tries;
  if (auto status = files->CheckAccess(); !status.ok()) return status;
  if (auto status = files->MakeDirectory(); !status.ok()) return status;
  if (auto status = files->FetchMeshes(); !status.ok()) return status;
  return files;
}

absl::Status RemoteFiles::CheckAccess() const {
  for (const auto& [name, object] : options_.remote.objects) {
    auto status = client::CheckAccess(object, transfer_);
    if (status.ok()) continue;
    if (absl::IsInvalidArgument(status)) {  // nothing has been read, so the request is wrong, and not the mesh
      SetErrorDetails({"BAD_SPEC", FieldOf(name), name, object.is_s3() ? "" : "https:", std::nullopt}, status);
    }
    return WithFile(status, FieldOf(name), name);
  }
  return absl::OkStatus();
}

absl::Status RemoteFiles::MakeDirectory() {
  const char* const given = std::getenv("TMPDIR");
  const std::string parent = given != nullptr && *given != '\0' ? given : "/tmp";
  directory_ = ProcessDirectory::Make(parent);
  if (directory_ == nullptr) {
    return absl::FailedPreconditionError(
        absl::StrCat("TMPDIR: a directory in ", parent, " cannot be made: ", std::strerror(errno)));
  }
  mark_ = std::make_unique<TemporaryDirectoryMark>(directory_->path());
  return absl::OkStatus();
}

// Each copy has a folder of its own, because parts are named like their files.
std::string RemoteFiles::NextPath(const RemoteName& remote) {
  const std::string folder = absl::StrCat(directory_->path(), "/", copies_.size());
  std::error_code ignored;  // who writes to it finds the error
  std::filesystem::create_directory(folder, ignored);
  std::string path = absl::StrCat(folder, "/", FileNameOf(remote));
  copies_.emplace_back(path, remote.name);
  return path;
}

absl::Status RemoteFiles::FetchMeshes() {
  for (std::string& mesh : local_.mesh.paths) {
    const auto found = options_.remote.objects.find(mesh);
    if (found == options_.remote.objects.end()) continue;
    mesh = NextPath(found->second);
    if (auto status = client::Fetch(found->second, mesh, transfer_); !status.ok()) return WithObject(status);
  }
  return absl::OkStatus();
}

absl::StatusOr<std::optional<std::string>> RemoteFiles::FindDone(const std::string& job_digest) {
  std::optional<std::string> voxels;
  for (const std::string& output : options_.outputs) {
    const auto object = options_.remote.objects.find(output);
    if (object == options_.remote.objects.end() || !object->second.is_s3()) return std::nullopt;
    const auto facts = FactsOf(object->second, transfer_);
    if (!facts.ok()) return facts.status();
    if (!*facts) return std::nullopt;
    const ObjectNotes& notes = (*facts)->notes;
    const auto job = notes.find(kJob), digest = notes.find(kVoxels);
    if (job == notes.end() || job->second != job_digest || digest == notes.end()) return std::nullopt;
    voxels = digest->second;
    bytes_[output] = (*facts)->bytes;
  }
  return voxels;
}

absl::StatusOr<bool> RemoteFiles::IsMissing(const std::string& output, const std::string& job_digest, uint64_t bytes) {
  const RemoteName& object = options_.remote.objects.at(output);
  const auto facts = FactsOf(object, transfer_);
  if (!facts.ok()) return facts.status();
  if (!*facts) return true;
  bytes_[output] = bytes;
  if (!object.is_s3()) return (*facts)->bytes > 0 && (*facts)->bytes != bytes;
  const auto job = (*facts)->notes.find(kJob);
  return (*facts)->bytes != bytes || job == (*facts)->notes.end() || job->second != job_digest;
}

absl::StatusOr<std::unique_ptr<Output>> RemoteFiles::Open(const std::string& output, const VoxelizeRequest& request) {
  OutputOptions options = options_.output_options;
  options.cancellation = transfer_.call.cancellation;
  const auto object = options_.remote.objects.find(output);
  if (object == options_.remote.objects.end()) return OpenOutput(output, request, options);
  const std::string path = NextPath(object->second);
  options.is_one_file = true;
  auto file = OpenOutput(path, request, options);
  if (!file.ok()) return Named(file.status());
  const auto notes = [this](const Summary& summary) -> ObjectNotes {
    if (job_digest_.empty()) return {};
    return {{kJob, job_digest_}, {kVoxels, summary.certificate.digest}};
  };
  return std::make_unique<RemoteOutput>(*std::move(file), path, object->second, transfer_, notes, bytes_[output]);
}

void RemoteFiles::Hook(JobHooks& hooks) {
  if (options_.remote.objects.empty()) return;
  hooks.open_output = [this](const std::string& output, const VoxelizeRequest& request) {
    return Open(output, request);
  };
  hooks.say = [this, say = hooks.say](const std::string& line) { say(Named(line)); };
  hooks.on_stage = [this, tell = hooks.on_stage](const std::string& stage) { tell(Named(stage)); };
}

std::string RemoteFiles::Named(const std::string& text) const {
  return copies_.empty() ? text : absl::StrReplaceAll(text, copies_);
}

absl::Status RemoteFiles::Named(const absl::Status& status) const {
  if (status.ok() || options_.remote.objects.empty()) return status;
  absl::Status named(status.code(), Named(std::string(status.message())));
  ErrorDetails details = GetErrorDetails(status);
  details.value = Named(details.value);
  SetErrorDetails(details, named);
  return WithObject(named);
}

absl::Status RemoteFiles::WithObject(absl::Status status) const {
  for (const auto& [name, object] : options_.remote.objects) status = WithFile(status, FieldOf(name), name);
  return status;
}

std::string RemoteFiles::FieldOf(const std::string& name) const {
  const std::vector<std::string>& outputs = options_.outputs;
  return std::find(outputs.begin(), outputs.end(), name) != outputs.end() ? "--out" : "mesh";
}

void RemoteFiles::Name(VoxelizeReport& report) const {
  report.mesh_path = NameOf(options_.mesh);
  for (Warning& warning : report.summary.warnings) warning.message = Named(warning.message);
}

uint64_t RemoteFiles::BytesOf(const std::string& output) const {
  const auto found = bytes_.find(output);
  return found == bytes_.end() ? 0 : found->second;
}

}  // namespace latvox::client
