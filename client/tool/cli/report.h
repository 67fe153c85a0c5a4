// Reports of finished calls for standard output.
#ifndef LATVOX_CLIENT_TOOL_CLI_REPORT_H_
#define LATVOX_CLIENT_TOOL_CLI_REPORT_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/mesh_files/weld_report.h"
#include "client/tool/cli/exit_status.h"
#include "latvox/grid/carried_names.h"
#include "latvox/grid/merge.h"
#include "latvox/plane_types.h"
#include "latvox/types.h"

namespace latvox::client {

struct VoxelizeReport {
  std::string mesh_path;
  std::vector<std::string> outputs;
  Accepted accepted;
  Summary summary;
  std::optional<IndexBox> index_box;           // of the voxels
  std::optional<uint32_t> default_resolution;  // if the request states no size
  bool is_fitted = false;                      // --dims decided on that resolution
  uint64_t skipped = 0;                        // points and lines of the mesh file
  std::optional<WeldReport> weld;              // if requested
  double read_ms = 0, encode_ms = 0;           // of the mesh
  double total_ms = 0;                         // the whole command
  uint64_t dropped = 0;                        // voxels that --alpha-cutoff left out
  CarriedNames names;                          // of the attributes that the voxels carry
  std::optional<Vec3d> leak_from;              // of the request
};

// Returns one JSON object. Scripts rely on its keys. Without verification, tunnels and redundant are null.
std::string ToJson(const VoxelizeReport& report);

// Returns a few lines for people.
std::string ToText(const VoxelizeReport& report);

// The outcome of one job of a batch.
struct JobResult {
  enum class Outcome { kDone, kFailed, kSkipped };  // kSkipped: an earlier run has done it
  Outcome outcome = Outcome::kFailed;
  std::string id, mesh;              // as in client/tool/cli/job_line.h
  uint64_t line = 0;                 // of the job file
  uint64_t ended_unix_ms = 0;        // since 1970
  std::vector<std::string> outputs;  // names below the directory
  std::vector<uint64_t> bytes;       // of each of these files, unless failed
  std::string job_digest;            // of client/tool/cli/job_digest.h; empty if the job failed before that
  std::string digest;                // of the voxels, if skipped
  VoxelizeReport report;             // if done
  absl::Status error;                // if failed
};

// Returns a JSON object in one line, without a line end.
std::string ToJsonLine(const JobResult& result);

struct BatchReport {
  uint64_t jobs = 0;  // of this worker
  uint64_t done = 0, failed = 0, skipped = 0;
  bool cancelled = false;             // before all jobs had ended
  std::vector<std::string> failures;  // one line for each of the first failures
  std::string results;                // path of the results file
  double total_ms = 0;
  ExitStatus status = ExitStatus::kDone;  // the status of the failed jobs; kOther if they differ
};

std::string ToJson(const BatchReport& report);
std::string ToText(const BatchReport& report);

struct PixelizeReport {
  std::string input_path;
  std::vector<std::string> outputs;
  uint64_t polylines = 0, points = 0;  // of the drawing
  uint32_t separability = 0;
  Pixelization answer;
  double read_ms = 0;   // reading the drawing
  double total_ms = 0;  // the whole command
};

std::string ToJson(const PixelizeReport& report);
std::string ToText(const PixelizeReport& report);

struct MergeReport {
  size_t parts = 0;
  std::string output;
  MergedGrid merged;
  double total_ms = 0;  // the whole command
};

std::string ToJson(const MergeReport& report);
std::string ToText(const MergeReport& report);

// Return one JSON object with the keys of the protocol, and one line for each limit.
std::string ToJson(const Limits& limits);
std::string ToText(const Limits& limits);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_REPORT_H_
