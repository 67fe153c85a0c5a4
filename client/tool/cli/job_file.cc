#include "client/tool/cli/job_file.h"

#include <filesystem>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "client/mesh_files/input.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/job_line.h"
#include "client/tool/output/output.h"
#include "client/tool/remote/remote_name.h"

namespace latvox::client {
namespace {

constexpr size_t kErrorsShown = 20;

// Outputs and ids that no two lines may share.
class Claims {
 public:
  explicit Claims(const std::string& directory) : directory_(Place(directory)) {}

  // Errors: INVALID_ARGUMENT naming the earlier line that has this output or id.
  absl::Status Add(uint64_t line, const Job& job) {
    for (const std::string& name : job.names) {
      if (auto status = Reserve(outputs_, "out", name, line); !status.ok()) return status;
    }
    if (job.id != job.names.front()) {
      if (auto status = Reserve(ids_, "id", job.id, line); !status.ok()) return status;
    }
    // Only these meshes can collide with outputs. Resolving the paths of millions of others would take long.
    for (const std::string& mesh : job.options.mesh.paths) {
      if (HasExtension(mesh, OutputExtensions())) inputs_.push_back({line, "mesh", mesh});
    }
    if (const std::string& align = job.options.align; !align.empty()) inputs_.push_back({line, "align", align});
    return absl::OkStatus();
  }

  // Calls tell(line, text) for every input that is an output of a job. Call it once, at the end.
  template <class Tell>
  void CheckInputs(const Tell& tell) const {
    for (const Input& input : inputs_) {
      const auto output =
          outputs_.find(IsRemote(input.path) ? input.path : Place(input.path).lexically_relative(directory_).string());
      if (output == outputs_.end()) continue;
      tell(input.line, absl::StrCat(input.field, ": \"", input.path, "\" is an output of line ", output->second));
    }
  }

 private:
  struct Input {
    uint64_t line;
    const char* field;
    std::string path;
  };
  using Lines = absl::flat_hash_map<std::string, uint64_t>;

  static absl::Status Reserve(Lines& lines, const char* field, const std::string& value, uint64_t line) {
    const auto [entry, fresh] = lines.emplace(value, line);
    if (fresh) return absl::OkStatus();
    return absl::InvalidArgumentError(absl::StrCat(field, ": \"", value, "\" is already used by line ", entry->second));
  }

  const std::filesystem::path directory_;
  Lines outputs_, ids_;
  std::vector<Input> inputs_;
};

}  // namespace

absl::StatusOr<JobFile> ReadJobFile(const std::string& path, const std::string& directory, const Worker& worker,
                                    const Cancellation& cancellation) {
  auto bytes = path == kStandardInput ? ReadStandardInput("a job file") : ReadBytes(path);
  if (!bytes.ok()) return bytes.status();
  JobFile file;
  file.text = std::make_unique<const std::string>(*std::move(bytes));
  JobParser parser(std::filesystem::path(path).parent_path().string(), directory);
  Claims claims(directory);
  const auto tell = [&](uint64_t line, absl::string_view what) {
    if (file.errors.size() < kErrorsShown)
      file.errors.push_back(absl::StrCat(NameOfInput(path), ":", line, ": ", what));
    ++file.wrong;
  };
  uint64_t number = 0;
  for (const absl::string_view text : absl::StrSplit(absl::string_view(*file.text), '\n')) {
    ++number;
    if (cancellation.cancelled()) return absl::CancelledError("cancelled");
    if (absl::StripAsciiWhitespace(text).empty()) continue;
    if (DoesJob(worker, file.jobs++)) file.lines.push_back(JobLine{number, text});
    const auto job = parser.Parse(text);
    const absl::Status status = job.ok() ? claims.Add(number, *job) : job.status();
    if (!status.ok()) tell(number, status.message());
  }
  if (file.jobs == 0) return absl::InvalidArgumentError(absl::StrCat(NameOfInput(path), ": contains no job"));
  claims.CheckInputs(tell);
  return file;
}

}  // namespace latvox::client
