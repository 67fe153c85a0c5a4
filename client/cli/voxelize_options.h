// The options of `latvox voxelize`.
#ifndef LATVOX_CLIENT_CLI_VOXELIZE_OPTIONS_H_
#define LATVOX_CLIENT_CLI_VOXELIZE_OPTIONS_H_

#include <CLI/App.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/cli/session.h"
#include "client/types.h"

namespace latvox::client {

struct VoxelizeOptions {
  std::string mesh;
  std::vector<std::string> outputs;
  VoxelizeRequest request;
  std::optional<int> quantization_bits;  // absent: auto
  bool json = false;
  ServerChoice server;
};

// The words as they are given; CLI11 writes into them, so that they must outlive its parsing.
struct VoxelizeWords {
  VoxelizeOptions options;  // filled in part by parsing
  std::string lattice, basis, voxel_size, resolution, origin, region, shard, quantization = "auto";
  int separability = 0;
  std::string algorithm, encoding, fill, cover, band;
  bool is_signed = false;
};

// Adds the outputs and what is asked for, without mesh and server. Parsing checks each option by itself.
void AddRequestOptions(CLI::App& command, VoxelizeWords& words);

// Adds all options.
void AddVoxelizeOptions(CLI::App& command, VoxelizeWords& words);

// What the words mean together. Throws CLI::ValidationError, as parsing does, naming option, value and limit: options
// that exclude or need each other.
VoxelizeOptions InterpretRequest(const VoxelizeWords& words);

// The same, with an eye on the file system: an output that is given twice or in the place of the mesh is refused, too.
VoxelizeOptions Interpret(const VoxelizeWords& words);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_CLI_VOXELIZE_OPTIONS_H_
