// The options of `latvox voxelize`.
#ifndef LATVOX_CLIENT_TOOL_CLI_VOXELIZE_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_VOXELIZE_OPTIONS_H_

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/tool/cli/mesh_options.h"
#include "client/tool/cli/session.h"
#include "client/tool/mesh_files/mesh_source.h"
#include "client/tool/output/output.h"
#include "deploy/manual/command_parser.h"
#include "latvox/types.h"

namespace latvox::client {

struct VoxelizeOptions {
  MeshSource mesh;
  bool weld_report = false;
  std::vector<std::string> outputs;
  OutputOptions output_options;
  VoxelizeRequest request;
  std::optional<int> quantization_bits;  // absent: auto
  std::string align;                     // a .vdb file whose grid is the request's; empty: none
  bool json = false;
  ServerChoice server;
};

// The words as they are given; parsing writes into them.
struct VoxelizeWords : MeshWords {
  VoxelizeOptions options;  // filled in part by parsing
  std::string lattice, basis, voxel_size, resolution, origin, region, bounds, shard, quantization = "auto";
  std::string npy, separability, algorithm, encoding, fill, interior_rule, cover, band, attributes;
  bool without_surface = false, force_open = false, is_signed = false;
  std::optional<bool> minimal;
};

// Adds all options.
void AddVoxelizeOptions(CommandParser& command, VoxelizeWords& words);

// What the words mean together. Throws UsageError, as parsing does, naming option, value and limit: options
// that exclude or need each other.
VoxelizeOptions InterpretRequest(const VoxelizeWords& words);

// The same, with an eye on the file system: an output that is given twice or in the place of the mesh is refused, too.
VoxelizeOptions Interpret(const VoxelizeWords& words);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_VOXELIZE_OPTIONS_H_
