#include "client/tool/cli/voxelize_command.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/clock.h"
#include "client/mesh/mesh_encoder.h"
#include "client/mesh/raw_mesh.h"
#include "client/mesh_files/mesh_file.h"
#include "client/mesh_files/mesh_source.h"
#include "client/mesh_files/weld_report.h"
#include "client/tool/cli/abandoned_work.h"
#include "client/tool/cli/mesh_names.h"
#include "client/tool/cli/progress_bar.h"
#include "client/tool/cli/warnings.h"
#include "client/tool/output/output.h"
#include "client/tool/output/standard_output.h"
#include "latvox/error.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

using Outputs = std::vector<std::unique_ptr<Output>>;

struct Upload {
  std::string bytes;  // a Draco stream, or the arrays of `raw`
  std::optional<RawMeshLayout> raw = std::nullopt;
  uint64_t skipped = 0;
  std::optional<WeldReport> weld = std::nullopt;
  CarriedNames names = {};
  std::vector<Warning> warnings = {};
};

// Estimates the voxels along the longest side of the mesh. In a basis of short and long vectors, counts along the short
// ones.
double VoxelsAlong(double side, const VoxelizeRequest& request) {
  double size = 1, shortest = 1;
  if (const Basis* basis = std::get_if<Basis>(&request.lattice)) {
    const auto& [a, b, c] = *basis;
    const double det =
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    const auto length = [](const Vec3d& v) { return std::hypot(v[0], v[1], v[2]); };
    size = std::cbrt(std::abs(det));
    shortest = std::min({1.0, length(a) / size, length(b) / size, length(c) / size});
  }
  const double voxels = request.resolution ? *request.resolution : side / request.voxel_size.value_or(size) + 1;
  return voxels / shortest;
}

// A Draco stream is sent as it is. Only --weld-report needs to decode it here.
absl::StatusOr<Upload> PrepareDraco(const VoxelizeOptions& options, const CallOptions& call, std::string drc) {
  Upload upload{.bytes = std::move(drc)};
  if (options.quantization_bits) {
    upload.warnings.push_back(
        {"QUANTIZATION_IGNORED", "--quantization does not apply to .drc, which is sent as it is", "--quantization"});
  }
  if (!options.weld_report) return upload;
  const auto count = [path = options.mesh.paths[0], upload]() mutable -> absl::StatusOr<Upload> {
    const auto mesh = ParseMeshFile(path, upload.bytes, MeshFormat::kDraco);
    if (!mesh.ok()) return mesh.status();
    upload.weld = Weld(*mesh);
    return upload;
  };
  return DoAbandonably(count, call);
}

// Sends doubles only if the mesh needs them, because Draco streams are smaller.
absl::StatusOr<Upload> Encode(const Mesh& mesh, int bits, const std::vector<Attribute>& attributes) {
  if (NeedsDoubles(mesh, bits)) {
    RawMesh raw = ToRaw(mesh, attributes);
    return Upload{.bytes = std::move(raw.bytes), .raw = std::move(raw.layout)};
  }
  auto encoded = EncodeMesh(mesh, bits, attributes);
  if (!encoded.ok()) return encoded.status();
  return Upload{.bytes = std::move(encoded->drc)};
}

absl::StatusOr<Upload> Prepare(const VoxelizeOptions& options, const CallOptions& call, const JobHooks& hooks) {
  hooks.on_stage(absl::StrCat("reading ", NameOf(options.mesh)));
  auto read = DoAbandonably([source = options.mesh] { return ReadMeshSource(source); }, call);
  if (!read.ok()) return read.status();
  if (auto* drc = std::get_if<std::string>(&*read)) return PrepareDraco(options, call, std::move(*drc));
  const auto shared_mesh = std::make_shared<const Mesh>(std::get<Mesh>(*std::move(read)));
  const Mesh& mesh = *shared_mesh;
  hooks.on_stage(absl::StrCat("encoding ", mesh.triangles.size(), " triangles"));
  const int bits =
      options.quantization_bits.value_or(AutoQuantizationBits(VoxelsAlong(LongestSide(mesh), options.request)));
  const auto encode = [shared_mesh, bits, attributes = options.request.attributes,
                       weld = options.weld_report]() -> absl::StatusOr<Upload> {
    auto upload = Encode(*shared_mesh, bits, attributes);
    if (!upload.ok()) return upload;
    upload->skipped = shared_mesh->skipped;
    upload->warnings = shared_mesh->warnings;
    upload->names = NamesOf(*shared_mesh, attributes);
    if (weld) upload->weld = Weld(*shared_mesh);
    return upload;
  };
  return DoAbandonably(encode, call);
}

absl::StatusOr<Outputs> OpenOutputs(const VoxelizeOptions& options) {
  Outputs outputs;
  for (const std::string& path : options.outputs) {
    auto output = OpenOutput(path, options.request, options.output_options);
    if (!output.ok()) return output.status();
    outputs.push_back(*std::move(output));
  }
  return outputs;
}

// Calls `step` with every output until one fails.
template <class Step>
absl::Status ForEach(Outputs& outputs, const Step& step) {
  for (auto& output : outputs) {
    if (auto status = step(*output); !status.ok()) return status;
  }
  return absl::OkStatus();
}

std::string ResumptionLine(const Resumption& resumption) {
  const std::string where = resumption.after_tile
                                ? absl::StrCat("resumed after tile ", absl::StrJoin(*resumption.after_tile, ","))
                                : "started again";
  return absl::StrCat("connection lost, ", where, " on ", resumption.address);
}

// Returns the status. Puts the mesh's file before the message if the mesh is at fault.
absl::Status WithMesh(const absl::Status& status, const MeshSource& mesh) {
  const ErrorDetails details = GetErrorDetails(status);
  if (details.reason != "BAD_MESH") return status;
  absl::Status named(status.code(), absl::StrCat(NameOf(mesh), ": ", status.message()));
  SetErrorDetails(details, named);
  return named;
}

// Runs the call and writes its results to the outputs.
absl::Status Call(const VoxelizeOptions& options, const Upload& upload, const CallOptions& call, const JobHooks& hooks,
                  Outputs& outputs, VoxelizeReport& report) {
  hooks.on_stage("connecting");
  const absl::StatusOr<const Client*> client = hooks.connect();
  if (!client.ok()) return client.status();
  hooks.on_stage("uploading");
  VoxelizeHandlers handlers;
  handlers.on_accepted = [&](const Accepted& accepted) {
    hooks.on_stage("voxelizing");
    report.accepted = accepted;
    return ForEach(outputs, [&](Output& output) { return output.Begin(accepted); });
  };
  uint64_t bricks = 0;
  handlers.on_bricks = [&](const BrickBatch& batch) {
    bricks += batch.bricks.size();
    hooks.on_progress(batch.progress, bricks);
    return ForEach(outputs, [&](Output& output) { return output.Add(batch); });
  };
  handlers.on_resumed = [&](const Resumption& resumption) {
    return hooks.say(ResumptionLine(resumption)), absl::OkStatus();
  };
  VoxelizeRequest request = options.request;
  request.raw_mesh = upload.raw;
  auto summary = (*client)->Voxelize(request, upload.bytes, handlers, call);
  if (!summary.ok()) return WithMesh(summary.status(), options.mesh);
  report.summary = *std::move(summary);
  return absl::OkStatus();
}

}  // namespace

absl::Status Align(VoxelizeOptions& options) {
  if (options.align.empty()) return absl::OkStatus();
  const auto info = ReadGridFileInfo(options.align);
  if (!info.ok()) return absl::Status(info.status().code(), absl::StrCat("align: ", info.status().message()));
  options.request.lattice = info->transform.basis;
  options.request.origin = info->transform.origin;
  return absl::OkStatus();
}

absl::StatusOr<VoxelizeReport> RunJob(const VoxelizeOptions& options, const CallOptions& call, const JobHooks& hooks) {
  const absl::Time start = absl::Now();
  VoxelizeReport report;
  report.mesh_path = NameOf(options.mesh);
  report.outputs = options.outputs;
  if (options.has_default_resolution) report.default_resolution = options.request.resolution;
  // Outputs come first, so that an unwritable path fails before any work.
  auto outputs = OpenOutputs(options);
  if (!outputs.ok()) return outputs.status();
  const auto upload = Prepare(options, call, hooks);
  if (!upload.ok()) return upload.status();
  report.names = upload->names;
  for (const auto& output : *outputs) output->SetNames(upload->names);
  report.skipped = upload->skipped;
  report.weld = upload->weld;
  std::vector<Warning> warnings = hooks.warnings;
  warnings.insert(warnings.end(), upload->warnings.begin(), upload->warnings.end());
  if (auto status = Warn(warnings, options.strict, hooks.say); !status.ok()) return status;
  report.encode_ms = absl::ToDoubleMilliseconds(absl::Now() - start);
  if (auto status = CheckTime(call); !status.ok()) return status;
  if (auto status = Call(options, *upload, call, hooks, *outputs, report); !status.ok()) return status;
  std::vector<Warning>& all = report.summary.warnings;
  if (auto status = Warn(all, options.strict, hooks.say); !status.ok()) return status;
  all.insert(all.begin(), warnings.begin(), warnings.end());
  if (!outputs->empty()) hooks.on_stage(absl::StrCat("writing ", absl::StrJoin(options.outputs, ", ")));
  const auto finish = [&](Output& output) { return output.Finish(report.summary); };
  if (auto status = ForEach(*outputs, finish); !status.ok()) return status;
  if (auto status = CheckTime(call); !status.ok()) return status;
  if (auto status = ForEach(*outputs, [](Output& output) { return output.Commit(); }); !status.ok()) return status;
  report.total_ms = absl::ToDoubleMilliseconds(absl::Now() - start);
  return report;
}

namespace {

absl::StatusOr<VoxelizeReport> RunToStandardOutput(VoxelizeOptions options, const CallOptions& call,
                                                   const JobHooks& hooks) {
  std::string& output = options.outputs[*options.standard_output];
  const auto file = StandardOutputFile::Create(std::filesystem::path(output).extension().string());
  if (!file.ok()) return file.status();
  output = (*file)->path();
  auto report = RunJob(options, call, hooks);
  if (!report.ok()) return report;
  report->outputs[*options.standard_output] = "standard output";
  if (absl::Status status = (*file)->Send(); !status.ok()) return status;
  return report;
}

}  // namespace

absl::StatusOr<VoxelizeReport> RunVoxelize(const VoxelizeOptions& given, const Cancellation& cancellation) {
  VoxelizeOptions options = given;
  if (absl::Status status = Align(options); !status.ok()) return status;
  const CallOptions call = MakeCallOptions(options.server, cancellation);
  std::optional<Session> session;
  ProgressBar bar;
  JobHooks hooks;
  hooks.connect = [&]() -> absl::StatusOr<const Client*> {
    auto opened = Session::Open(options.server, call);
    if (!opened.ok()) return opened.status();
    session = *std::move(opened);
    return &session->client();
  };
  hooks.on_stage = [&](const std::string& stage) { bar.Stage(stage); };
  hooks.on_progress = [&](double share, uint64_t bricks) { bar.Show(share, "bricks", bricks); };
  hooks.say = [&](const std::string& line) { bar.Say("latvox: " + line); };
  // A summary in JSON has the transform.
  if (auto warning = WarningOfPlace(options.outputs); warning && !options.json) hooks.warnings = {*std::move(warning)};
  return options.standard_output ? RunToStandardOutput(options, call, hooks) : RunJob(options, call, hooks);
}

}  // namespace latvox::client
