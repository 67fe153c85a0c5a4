// The options of `latvox voxelize`.
#ifndef LATVOX_CLIENT_TOOL_CLI_VOXELIZE_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_VOXELIZE_OPTIONS_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/mesh_files/mesh_source.h"
#include "client/tool/cli/mesh_options.h"
#include "client/tool/cli/remote_names.h"
#include "client/tool/cli/request_words.h"
#include "client/tool/cli/session.h"
#include "client/tool/cli/shape_options.h"
#include "client/tool/output/output.h"
#include "deploy/manual/command_parser.h"
#include "latvox/types.h"

namespace latvox::client {

inline constexpr char kStandardOutput[] = "-", kDefaultFormat[] = "vdb";

struct VoxelizeOptions {
  MeshSource mesh;
  bool weld_report = false;
  std::vector<std::string> outputs;
  RemoteNames remote;
  std::optional<size_t> standard_output;  // index in `outputs` of the one that is sent there: only its extension counts
  OutputOptions output_options;
  VoxelizeRequest request;
  bool has_default_resolution = false;  // with dims of output_options, they decide on it

  bool is_fitted() const { return has_default_resolution && output_options.shape.dims; }

  UploadForm upload = UploadForm::kAuto;
  std::optional<int> quantization_bits;  // absent: auto
  std::optional<double> alpha_cutoff;    // voxels of less opacity are left out
  // Words of --priority and --fraction-labels, if some are names: the mesh's file tells their numbers.
  std::vector<std::string> priority, fraction_labels;
  std::string align;    // .vdb file whose grid the request uses; empty: none
  bool strict = false;  // a warning is an error
  bool json = false;
  ServerChoice server;
};

// The words as given. Parsing writes into them.
struct VoxelizeWords : MeshWords {
  VoxelizeOptions options;  // partly filled by parsing
  ShapeWords shape;
  std::string lattice, basis, voxel_size, resolution, origin, region, bounds, shard, quantization = "auto";
  std::string output_format, separability, algorithm, upload, encoding, set, rule, placement, band, side, fields,
      labels, priority, fraction_labels, alpha_cutoff;
  std::string seed, close, leak_from;
  bool force_open = false, is_signed = false, allow_outside = false;
  std::optional<bool> minimal;
};

// Adds all options.
void AddVoxelizeOptions(CommandParser& command, VoxelizeWords& words);

// Replaces URLs among meshes and outputs by their names, and keeps them in `remote`. Throws UsageError for those of
// NameRemotes and NameRemoteOutputs.
void NameRemoteFiles(VoxelizeOptions& options);

// Returns the options that the words mean together. Throws UsageError, as parsing does, naming option, value and limit:
// options that exclude or need each other.
VoxelizeOptions InterpretRequest(const VoxelizeWords& words);

// Does the same for one call of the tool: an output that is not given gets its name from the mesh, and - is standard
// output. Also refuses an output that is given twice, or is the mesh, or has only the mesh's name and exists already.
// Looks at the file system.
VoxelizeOptions Interpret(const VoxelizeWords& words);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_VOXELIZE_OPTIONS_H_
