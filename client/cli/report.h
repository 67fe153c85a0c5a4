// What the tool says about a finished call, on standard output.
#ifndef LATVOX_CLIENT_CLI_REPORT_H_
#define LATVOX_CLIENT_CLI_REPORT_H_

#include <string>
#include <vector>

#include "client/grid/merge.h"
#include "client/plane_types.h"
#include "client/types.h"

namespace latvox::client {

struct VoxelizeReport {
  std::string mesh_path;
  std::vector<std::string> outputs;
  Accepted accepted;
  Summary summary;
  uint64_t skipped = 0;  // points and lines of the mesh file
  double encode_ms = 0;  // reading and encoding the mesh
  double total_ms = 0;   // the whole command
};

// One object; scripts rely on its keys. Without verification, tunnels and redundant are null.
std::string ToJson(const VoxelizeReport& report);

// A few lines for people.
std::string ToText(const VoxelizeReport& report);

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

// One object, keys as in the protocol; a line for each.
std::string ToJson(const Limits& limits);
std::string ToText(const Limits& limits);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_CLI_REPORT_H_
