#include "client/tool/cli/voxelize_options.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/mesh_files/input.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/request_rows.h"
#include "client/tool/cli/request_words.h"
#include "client/tool/cli/set_options.h"
#include "client/tool/cli/shape_options.h"
#include "client/tool/output/output.h"
#include "client/tool/remote/remote_name.h"
#include "client/tool/view/page.h"
#include "latvox/error.h"
#include "latvox/stretched.h"

namespace latvox::client {
namespace {

std::variant<NamedLattice, Basis> InterpretLattice(const VoxelizeWords& words) {
  if (!words.basis.empty()) {
    std::array<double, 9> n{};
    ParseNumbers(words.basis, n);
    return Basis{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]}};
  }
  return ValueNamed(LatticeNames(), words.lattice);
}

// Reads one size, or one per axis.
void InterpretVoxelSize(const VoxelizeWords& words, VoxelizeRequest& request) {
  const std::string& text = words.voxel_size;
  Vec3d sizes;
  if (text.empty()) return;
  if (!ParseNumbers(text, sizes)) {
    ParseNumber(text, request.voxel_size.emplace());
  } else if (!words.basis.empty()) {
    Refuse("--voxel-size: --basis allows only one number, not ", text);
  } else if (sizes[0] == sizes[1] && sizes[0] == sizes[2]) {
    request.voxel_size = sizes[0];
  } else {
    request.lattice = Stretched(std::get<NamedLattice>(request.lattice), sizes);
  }
}

// Refuses outputs that cannot hold the voxels. With --align, their lattice is unknown until the file is read.
void CheckHeld(const VoxelizeOptions& options, const ShapeWords& words) {
  ToHold voxels = ToHoldOf(options.request);
  if (!options.align.empty()) voxels.basis.reset();
  CheckArray(voxels.fields, options.output_options);
  for (size_t n = 0; n < options.outputs.size(); ++n) {
    const std::string& output = options.outputs[n];
    OutputOptions of_output = options.output_options;
    of_output.is_one_file = n == options.standard_output || IsRemote(output);
    if (!HasExtension(output, OutputExtensions())) continue;  // another check names the extension
    const auto not_held = WhyNotHeld(output, voxels, of_output);
    if (!not_held) continue;
    if (not_held->is_lattice) {
      throw UsageError(absl::StrCat("--out: ", output, ": ", not_held->text), {"--out", output, not_held->able});
    }
    if (voxels.fields.empty()) Refuse("--fields: ", output, " needs links, link_triangles or link_crossings");
    const bool is_selected = of_output.array && IsLimited(output, of_output);
    const std::string option = is_selected ? "--array" : "--fields";
    const std::vector<Field>& held = is_selected ? *of_output.array : voxels.fields;
    throw UsageError(absl::StrCat(option, ": ", output, " ", not_held->text),
                     {option, JoinNames(held), not_held->able});
  }
  CheckShape(words, options.outputs, options.output_options, voxels);
}

// Reads --separability. 26, 18 and 6 count a voxel's neighbors, which is right only on the Cartesian lattice. With
// --align the lattice may be any.
uint32_t InterpretSeparability(const VoxelizeWords& words, const std::variant<NamedLattice, Basis>& lattice) {
  uint32_t given = 0;
  if (!words.separability.empty()) ParseNumber(words.separability, given);
  if (given <= 2) return given;
  if (!words.options.align.empty() || lattice != std::variant<NamedLattice, Basis>(NamedLattice::kCartesian)) {
    throw UsageError(
        absl::StrCat("--separability: ", given, " requires --lattice cartesian; other lattices allow 0, 1 or 2"),
        {"--separability", absl::StrCat(given), "0, 1 or 2"});
  }
  return given == 26 ? 0 : given == 18 ? 1 : 2;
}

// Returns the note that reproduces this mesh.
MeshNote NoteOf(const VoxelizeOptions& options, const VoxelizeWords& words) {
  MeshNote note;
  note.up_axis = words.up_axis;
  if (!words.scale.empty()) note.scale = options.mesh.scale;
  note.input_format = words.input_format;
  note.quantization = options.quantization_bits;
  note.skip_bad = words.skip_bad;
  note.alpha_cutoff = options.alpha_cutoff;
  note.priority = options.priority;
  note.fraction_labels = options.fraction_labels;
  return note;
}

void InterpretPart(const VoxelizeWords& words, VoxelizeRequest& request) {
  if (!words.region.empty()) {
    std::array<int32_t, 6> n{};
    ParseNumbers(words.region, n);
    request.region = IndexBox{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  }
  if (!words.bounds.empty()) {
    std::array<double, 6> n{};
    ParseNumbers(words.bounds, n);
    request.bounds = WorldBox{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
  }
  if (!words.shard.empty()) request.shard = ParseShard(words.shard);
}

// The resolution that --dims decides on is at most this, because no step along an index of a named lattice is longer
// than two voxels. It is that of the upload; the job then finds the right one.
uint32_t DefaultResolution(const BoxShape& shape) {
  if (!shape.dims) return kDefaultResolution;
  const int64_t least = *std::min_element(shape.dims->begin(), shape.dims->end()) - 2 * int64_t{shape.pad};
  if (least < 1) {
    const std::string dims = absl::StrJoin(*shape.dims, ",");
    throw UsageError(absl::StrCat("--dims: ", dims, " with --pad ", shape.pad, " leaves no voxel along a side"),
                     {"--dims", dims, absl::StrCat(2 * int64_t{shape.pad} + 1)});
  }
  const int64_t most = *std::max_element(shape.dims->begin(), shape.dims->end());
  return static_cast<uint32_t>(std::clamp<int64_t>(2 * most, kMinResolution, kMaxResolution));
}

OptionRow OutputFormatRow(VoxelizeWords& words) {
  OptionRow row = {.names = "--output-format",
                   .target = &words.output_format,
                   .help = "Format of -o -",
                   .group = "Output",
                   .standard = kDefaultFormat};
  for (const auto& [word, what] : StreamedFormats()) {
    row.words.push_back(word);
    row.word_help.push_back(what);
  }
  return row;
}

// Returns the mesh's name with .vdb, in the current folder.
std::string DefaultOutput(const VoxelizeOptions& options) {
  const std::string& mesh = options.mesh.paths.front();
  if (mesh == kStandardInput) Refuse("--out is required: a mesh from standard input has no name");
  std::filesystem::path unpacked = std::filesystem::path(mesh).filename();
  if (unpacked.extension() == ".gz") unpacked = unpacked.stem();
  const std::string name = unpacked.stem().string() + "." + kDefaultFormat;
  if (std::filesystem::exists(std::filesystem::path(name))) {
    Refuse("--out: ", name, ", the output's name by default, exists already; -o ", name, " replaces it");
  }
  return name;
}

void InterpretOutputs(VoxelizeWords& words) {
  VoxelizeOptions& options = words.options;
  std::vector<std::string>& outputs = options.outputs;
  const auto standard = std::find(outputs.begin(), outputs.end(), kStandardOutput);
  if (standard == outputs.end()) {
    if (!words.output_format.empty()) Refuse("--output-format: ", words.output_format, " needs -o -");
    if (outputs.empty() && !options.json && !options.request.verify) outputs.push_back(DefaultOutput(options));
    return;
  }
  if (std::count(standard, outputs.end(), kStandardOutput) > 1) Refuse("--out: - is given twice");
  if (options.json) Refuse("--json cannot be combined with -o -, because both write to standard output");
  const std::string format = words.output_format.empty() ? kDefaultFormat : words.output_format;
  if (format != "csv" && isatty(STDOUT_FILENO) != 0) {
    Refuse("--out: - is a terminal, which cannot show ", format, "; send it to a file or another program");
  }
  options.standard_output = static_cast<size_t>(standard - outputs.begin());
  *standard = absl::StrCat(kStandardOutput, ".", format);
}

}  // namespace

void AddVoxelizeOptions(CommandParser& command, VoxelizeWords& words) {
  command.Add({MeshRow(words.options.mesh)});
  AddRequestOptions(command, words);
  command.Add({OutputFormatRow(words), JsonRow("Print the summary as JSON", words.options.json),
               AllowHttpRow(words.options.remote.allow_http)});
  AddServerOptions(command, words.options.server);
}

void InterpretUpload(const VoxelizeWords& words, VoxelizeOptions& options) {
  options.upload = ValueNamed(UploadNames(), words.upload);
  if (words.quantization != "auto") ParseNumber(words.quantization, options.quantization_bits.emplace());
  if (options.upload == UploadForm::kRaw && options.quantization_bits.value_or(0) > 0) {
    Refuse("--quantization: ", words.quantization, " needs --upload draco; raw positions are exact");
  }
}

VoxelizeOptions InterpretRequest(const VoxelizeWords& words) {
  VoxelizeOptions options = words.options;
  VoxelizeRequest& request = options.request;
  request.lattice = InterpretLattice(words);
  request.algorithm = ValueNamed(AlgorithmNames(), words.algorithm);
  request.minimal = words.minimal;
  request.encoding = ValueNamed(EncodingNames(), words.encoding);
  request.set = InterpretSet(words);
  request.separability = InterpretSeparability(words, request.lattice);
  InterpretVoxelSize(words, request);
  if (!words.resolution.empty()) ParseNumber(words.resolution, request.resolution.emplace());
  if (!words.placement.empty()) request.placement = ValueNamed(PlacementNames(), words.placement);
  if (!words.origin.empty()) ParseNumbers(words.origin, request.origin.emplace());
  InterpretPart(words, request);
  InterpretShape(words.shape, options.outputs, options.output_options);
  InterpretMesh(words, options.mesh);
  options.strict = words.strict;
  if (!words.up_axis.empty()) options.output_options.picture_up = UpAxis::kZ;
  InterpretUpload(words, options);
  InterpretFields(words, options);
  CheckHeld(options, words.shape);
  options.output_options.note = NoteOf(options, words);
  options.output_options.make_page = ViewPage;
  if (words.basis.empty() && options.align.empty() && words.voxel_size.empty() && !request.resolution) {
    request.resolution = DefaultResolution(options.output_options.shape);
    options.has_default_resolution = true;
  }
  return options;
}

void NameRemoteFiles(VoxelizeOptions& options) {
  for (const absl::Status& status :
       {NameRemotes(options.mesh.paths, options.remote), NameRemoteOutputs(options.outputs, options.remote)}) {
    if (status.ok()) continue;
    const ErrorDetails details = GetErrorDetails(status);
    throw UsageError(std::string(status.message()), {details.field, details.value, details.limit});
  }
}

VoxelizeOptions Interpret(const VoxelizeWords& given) {
  VoxelizeWords words = given;
  NameRemoteFiles(words.options);
  InterpretOutputs(words);
  VoxelizeOptions options = InterpretRequest(words);
  CheckMeshPaths(options.mesh, options.outputs);
  return options;
}

}  // namespace latvox::client
