#include "client/tool/cli/voxelize_command.h"

#include <memory>
#include <optional>
#include <utility>
#include <variant>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "client/mesh_files/mesh_source.h"
#include "client/tool/cli/abandoned_work.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/dims_resolution.h"
#include "client/tool/cli/grid_input.h"
#include "client/tool/cli/mesh_names.h"
#include "client/tool/cli/mesh_upload.h"
#include "client/tool/cli/option_words.h"
#include "client/tool/cli/progress_bar.h"
#include "client/tool/cli/remote_files.h"
#include "client/tool/cli/set_labels.h"
#include "client/tool/cli/warnings.h"
#include "client/tool/output/box_shape.h"
#include "client/tool/output/output.h"
#include "client/tool/output/outputs.h"
#include "client/tool/output/standard_output.h"
#include "client/tool/texture/color_stream.h"
#include "latvox/error.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

absl::StatusOr<Outputs> OpenOutputs(const VoxelizeOptions& options, const JobHooks& hooks) {
  Outputs outputs;
  for (const std::string& path : options.outputs) {
    auto output = hooks.open_output ? hooks.open_output(path, options.request)
                                    : OpenOutput(path, options.request, options.output_options);
    if (!output.ok()) return output.status();
    outputs.push_back(*std::move(output));
  }
  return outputs;
}

std::string ResumptionLine(const Resumption& resumption) {
  const std::string where = resumption.after_tile
                                ? absl::StrCat("resumed after tile ", absl::StrJoin(*resumption.after_tile, ","))
                                : "started again";
  return absl::StrCat("connection lost, ", where, " on ", resumption.address);
}

// Returns the status. Puts the mesh's file before the message if the mesh is at fault. Arrays are named "mesh", as the
// server names every mesh.
absl::Status WithMesh(const absl::Status& status, const MeshSource& mesh) {
  const ErrorDetails details = GetErrorDetails(status);
  const std::string prefix = NameOf(mesh) + ": ";
  if (details.reason != "BAD_MESH" || absl::StartsWith(status.message(), prefix)) return status;
  absl::Status named(status.code(), absl::StrCat(prefix, status.message()));
  SetErrorDetails(details, named);
  return named;
}

// Writes the labels that options name to the request.
absl::Status ReplaceNames(const VoxelizeOptions& options, const CarriedNames& names, VoxelizeRequest& request) {
  const std::optional<SetLabels> of_set = LabelsOf(request.set);
  const auto replace = [&](const char* option, const std::vector<std::string>& words, std::vector<uint32_t>& labels) {
    if (words.empty()) return absl::OkStatus();
    auto numbers = LabelsNamed(words, option, of_set->field, names);
    if (numbers.ok()) labels = *std::move(numbers);
    return numbers.status();
  };
  if (!of_set) {
    return options.fraction_labels.empty()
               ? absl::OkStatus()
               : ToStatus(UsageError("--fraction-labels: names need --labels part or material"));
  }
  if (auto status = replace("--priority", options.priority, of_set->priority); !status.ok()) return status;
  return replace("--fraction-labels", options.fraction_labels, request.fraction_labels);
}

// Runs the call and writes its results to the outputs.
absl::Status Call(const Client& client, const VoxelizeOptions& options, const MeshUpload& upload,
                  const CallOptions& call, const JobHooks& hooks, Outputs& outputs, std::vector<Warning>& warnings,
                  VoxelizeReport& report) {
  hooks.on_stage("uploading");
  std::optional<ColorStream> colors;
  if (upload.base_colors) colors.emplace(*upload.base_colors, options.request, options.alpha_cutoff);
  VoxelizeHandlers handlers;
  handlers.on_accepted = [&](const Accepted& accepted) {
    hooks.on_stage("voxelizing");
    report.accepted = accepted;
    if (auto large = WarningOfSize(accepted, options.request)) {
      if (auto status = Warn({*large}, options.strict, hooks.say); !status.ok()) return status;
      warnings.push_back(*std::move(large));
    }
    if (colors) colors->Begin(accepted);
    return ForAllAtOnce(outputs, call.cancellation, [&](Output& output) { return output.Begin(accepted); });
  };
  uint64_t bricks = 0;
  VoxelBox box;
  handlers.on_bricks = [&](const BrickBatch& received) {
    bricks += received.bricks.size();
    hooks.on_progress(received.progress, bricks);
    const BrickBatch batch = colors ? colors->Convert(received) : received;
    for (const Brick& brick : batch.bricks) box.Add(brick);
    return ForAllAtOnce(outputs, call.cancellation, [&](Output& output) { return output.Add(batch); });
  };
  handlers.on_resumed = [&](const Resumption& resumption) {
    return hooks.say(ResumptionLine(resumption)), absl::OkStatus();
  };
  VoxelizeRequest request = colors ? colors->ToSend() : options.request;
  request.raw_mesh = upload.raw;
  if (absl::Status status = ReplaceNames(options, upload.names, request); !status.ok()) return status;
  auto summary = client.Voxelize(request, upload.bytes, handlers, call);
  if (!summary.ok()) return WithMesh(WithOptions(summary.status(), options.request), options.mesh);
  report.summary = *std::move(summary);
  report.index_box = box.box();
  if (!colors) return absl::OkStatus();
  colors->Finish(report.summary);
  report.dropped = colors->dropped();
  return absl::OkStatus();
}

}  // namespace

absl::Status Align(VoxelizeOptions& options, const Cancellation& cancellation) {
  if (options.align.empty()) return absl::OkStatus();
  const auto info = ReadInputInfo(options.align, cancellation);
  if (!info.ok()) return absl::Status(info.status().code(), absl::StrCat("align: ", info.status().message()));
  options.request.lattice = info->transform.basis;
  options.request.origin = info->transform.origin;
  return absl::OkStatus();
}

namespace {

// Returns the resolution that --dims decides on: that of the whole, because parts with different ones do not join.
absl::StatusOr<uint32_t> FitResolution(const Client& client, VoxelizeOptions options, const MeshUpload& upload,
                                       const CallOptions& call, const JobHooks& hooks) {
  JobHooks quiet = hooks;
  quiet.on_stage = [](const std::string&) {};
  quiet.on_progress = [](double, uint64_t) {};
  quiet.say = [](const std::string&) {};
  hooks.on_stage("choosing a resolution");
  options.strict = options.request.verify = false;
  options.request.region.reset();
  options.request.bounds.reset();
  options.request.shard.reset();
  return FindResolution(options.output_options.shape,
                        [&](uint32_t resolution) -> absl::StatusOr<std::optional<IndexBox>> {
                          options.request.resolution = resolution;
                          Outputs no_outputs;
                          std::vector<Warning> warnings;
                          VoxelizeReport report;
                          auto status = Call(client, options, upload, call, quiet, no_outputs, warnings, report);
                          if (!status.ok()) return status;
                          return report.index_box;
                        });
}

}  // namespace

absl::StatusOr<VoxelizeReport> RunJob(const VoxelizeOptions& given, const CallOptions& call, const JobHooks& hooks) {
  const absl::Time start = absl::Now();
  VoxelizeOptions options = given;
  options.output_options.cancellation = call.cancellation;
  VoxelizeReport report;
  report.mesh_path = NameOf(options.mesh);
  report.outputs = options.outputs;
  // Outputs come first, so that an unwritable path fails before any work.
  auto outputs = OpenOutputs(options, hooks);
  if (!outputs.ok()) return outputs.status();
  const MeshReader read_files = [source = options.mesh] { return ReadMeshSource(source); };
  const auto upload = PrepareUpload(options, hooks.read_mesh ? hooks.read_mesh : read_files, HasNetwork(options.server),
                                    call, hooks.on_stage);
  if (!upload.ok()) return upload.status();
  report.names = upload->names;
  report.skipped = upload->skipped;
  report.weld = upload->weld;
  if (const auto* enclosed = std::get_if<Enclosed>(&options.request.set)) report.leak_from = enclosed->leak_from;
  std::vector<Warning> warnings = hooks.warnings;
  warnings.insert(warnings.end(), upload->warnings.begin(), upload->warnings.end());
  if (auto status = Warn(warnings, options.strict, hooks.say); !status.ok()) return status;
  report.read_ms = upload->read_ms;
  report.encode_ms = upload->encode_ms;
  if (auto status = CheckTime(call); !status.ok()) return status;
  hooks.on_stage("connecting");
  const absl::StatusOr<const Client*> client = hooks.connect();
  if (!client.ok()) return client.status();
  if (options.is_fitted()) {
    const auto resolution = FitResolution(**client, options, *upload, call, hooks);
    if (!resolution.ok()) return resolution.status();
    options.request.resolution = *resolution;
    report.is_fitted = true;
    outputs->clear();
    outputs = OpenOutputs(options, hooks);  // they may hold the request
    if (!outputs.ok()) return outputs.status();
  }
  if (options.has_default_resolution) report.default_resolution = options.request.resolution;
  if (hooks.receive) outputs->push_back(hooks.receive(options.request));
  for (const auto& output : *outputs) output->SetNames(upload->names);
  if (auto status = Call(**client, options, *upload, call, hooks, *outputs, warnings, report); !status.ok()) {
    return status;
  }
  if (hooks.disconnect) hooks.disconnect();
  std::vector<Warning>& all = report.summary.warnings;
  if (auto status = Warn(all, options.strict, hooks.say); !status.ok()) return status;
  all.insert(all.begin(), warnings.begin(), warnings.end());
  if (!outputs->empty()) hooks.on_stage(absl::StrCat("writing ", absl::StrJoin(options.outputs, ", ")));
  const std::vector<Warning> of_files = WarningsOf(*outputs);
  if (auto status = Warn(of_files, options.strict, hooks.say); !status.ok()) return status;
  const auto finish = [&](Output& output) { return output.Finish(report.summary); };
  if (auto status = ForAllAtOnce(*outputs, call.cancellation, finish); !status.ok()) return status;
  all.insert(all.end(), of_files.begin(), of_files.end());  // last: a grid does not tell about other files
  if (auto status = CheckTime(call); !status.ok()) return status;
  if (auto status = CommitAll(*outputs); !status.ok()) return status;
  report.total_ms = absl::ToDoubleMilliseconds(absl::Now() - start);
  return report;
}

namespace {

absl::StatusOr<VoxelizeReport> RunToStandardOutput(VoxelizeOptions options, const CallOptions& call,
                                                   const JobHooks& hooks) {
  std::string& output = options.outputs[*options.standard_output];
  const auto file = StandardOutputFile::Create(ExtensionOf(output));
  if (!file.ok()) return file.status();
  output = (*file)->path();
  auto report = RunJob(options, call, hooks);
  if (!report.ok()) return report;
  report->outputs[*options.standard_output] = "standard output";
  if (absl::Status status = (*file)->Send(); !status.ok()) return status;
  return report;
}

// Runs the job with local copies of remote meshes.
absl::StatusOr<VoxelizeReport> RunWithCopies(const VoxelizeOptions& options, const CallOptions& call, JobHooks hooks) {
  if (!options.remote.objects.empty()) hooks.on_stage(absl::StrCat("fetching ", NameOf(options.mesh)));
  const auto files = RemoteFiles::Fetch(options, call);
  if (!files.ok()) return files.status();
  (*files)->Hook(hooks);
  const VoxelizeOptions& local = (*files)->local();
  auto report = options.standard_output ? RunToStandardOutput(local, call, hooks) : RunJob(local, call, hooks);
  if (!report.ok()) return (*files)->Named(report.status());
  (*files)->Name(*report);
  return report;
}

}  // namespace

absl::StatusOr<VoxelizeReport> RunVoxelize(const VoxelizeOptions& given, const Cancellation& cancellation) {
  VoxelizeOptions options = given;
  if (absl::Status status = Align(options, cancellation); !status.ok()) return status;
  const CallOptions call = MakeCallOptions(options.server, cancellation);
  Session session(options.server);
  ProgressBar bar;
  JobHooks hooks;
  hooks.connect = [&]() -> absl::StatusOr<const Client*> {
    if (absl::Status status = session.Connect(call); !status.ok()) return status;
    return &session.client();
  };
  hooks.disconnect = [&] { session.Disconnect(); };
  hooks.on_stage = [&](const std::string& stage) { bar.Stage(stage); };
  hooks.on_progress = [&](double share, uint64_t bricks) { bar.Show(share, "bricks", bricks); };
  hooks.say = [&](const std::string& line) { bar.Say("latvox: " + line); };
  // A summary in JSON has the transform.
  if (auto warning = WarningOfPlace(options.outputs); warning && !options.json) hooks.warnings = {*std::move(warning)};
  return RunWithCopies(options, call, hooks);
}

}  // namespace latvox::client
