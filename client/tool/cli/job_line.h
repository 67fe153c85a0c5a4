// One line of a job file: a JSON object.
//
//   mesh    the only required field: a path or URL (file:, https:, http:, s3:), or an array of several, which form one
//           mesh. A relative path starts at the job file's folder, or at the working directory if the job file is
//           standard input.
//   out     file name below the output directory, or a URL (https:, http:, s3:), or an array of several; default: the
//           first mesh's name with .vdb
//   id      unique name in the results; default: the first of out
//   others  the long options of `latvox voxelize`, with _ in place of -: lattice, basis, voxel_size, ... Numbers are
//           numbers, lists are arrays, flags are true or false. A relative path of align starts where that of mesh
//           does.
#ifndef LATVOX_CLIENT_TOOL_CLI_JOB_LINE_H_
#define LATVOX_CLIENT_TOOL_CLI_JOB_LINE_H_

#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/tool/cli/voxelize_options.h"
#include "deploy/manual/command_parser.h"

namespace latvox::client {

struct Job {
  std::string id, mesh;            // mesh: as given, without queries; several are joined with +
  std::vector<std::string> names;  // of the outputs: of a remote one its name, of others below the directory
  VoxelizeOptions options;         // with absolute paths and remote names; their server is ignored
};

// Parses lines with the command line's tables of options. Not thread-safe.
class JobParser {
 public:
  // `folder` is that of the job file, `directory` that of the outputs.
  JobParser(std::string folder, std::string directory);
  JobParser(const JobParser&) = delete;
  JobParser& operator=(const JobParser&) = delete;

  // Errors: INVALID_ARGUMENT naming field, value and limit: not a JSON object; a field that is unknown, given twice, of
  // the wrong type, out of range, or not allowed with another. Does not access the file system, which may be slow: see
  // CheckPlaces.
  absl::StatusOr<Job> Parse(absl::string_view line);

  // Returns the error with fields of a line in place of options.
  absl::Status WithFields(const absl::Status& error) const;

 private:
  const std::string folder_, directory_;
  VoxelizeWords words_;  // parser_ writes into it
  CommandParser parser_;
  std::vector<std::pair<std::string, std::string>> names_;  // option and field, "--voxel-size" and "voxel_size"
};

// Errors: INVALID_ARGUMENT if an output is a mesh or another output once links are resolved.
absl::Status CheckPlaces(const Job& job);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_JOB_LINE_H_
