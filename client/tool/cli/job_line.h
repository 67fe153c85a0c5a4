// One line of a job file: a JSON object.
//
//   mesh    path, below the job file's folder (the working directory, for standard input) unless it is absolute, or
//           file: URL; or an array of several, which are one mesh; the only field that must be there
//   out     file name below the output directory, or an array of several; default: the first mesh's name with .vdb
//   id      a name of its own in results; default: the first of out
//   others  what the long options of `latvox voxelize` with these names ask for, with _ for -: lattice, basis,
//           voxel_size, ... Numbers are numbers, lists of them arrays, and flags true or false. The path of align is
//           taken like that of mesh.
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
  std::string id, mesh;            // mesh: as it is given, several with + between them
  std::vector<std::string> names;  // of the outputs, below the directory, in normal form
  VoxelizeOptions options;         // whose paths are whole, and whose server does not count
};

// Reads lines by the rules of the command line's options. Not thread-safe.
class JobParser {
 public:
  // `folder`: of the job file; `directory`: for the outputs.
  JobParser(std::string folder, std::string directory);
  JobParser(const JobParser&) = delete;
  JobParser& operator=(const JobParser&) = delete;

  // Errors: INVALID_ARGUMENT, naming field, value and limit: no JSON object, a field that is unknown or stands twice,
  // of another type, out of its range, or that goes not with another. The file system, which may be a slow one, is not
  // looked at: see CheckPlaces.
  absl::StatusOr<Job> Parse(absl::string_view line);

 private:
  const std::string folder_, directory_;
  VoxelizeWords words_;  // what parser_ writes into
  CommandParser parser_;
  std::vector<std::pair<std::string, std::string>> names_;  // option and field, "--voxel-size" and "voxel_size"
};

// Errors: INVALID_ARGUMENT if an output would take the place of a mesh, or of another output, by whatever links.
absl::Status CheckPlaces(const Job& job);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_JOB_LINE_H_
