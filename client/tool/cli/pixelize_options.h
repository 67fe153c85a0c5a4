// The options of `latvox pixelize`.
#ifndef LATVOX_CLIENT_TOOL_CLI_PIXELIZE_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_PIXELIZE_OPTIONS_H_

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "client/tool/cli/session.h"
#include "latvox/plane_types.h"

namespace latvox::client {

struct PixelizeOptions {
  std::string input;
  std::vector<std::string> outputs;
  PixelizeRequest request;  // all but the polylines
  bool json = false;
  ServerChoice server;
};

// The words as they are given; CLI11 writes into them, so that they must outlive its parsing.
struct PixelizeWords {
  PixelizeOptions options;  // filled in part by parsing
  std::string lattice, basis, pixel_size, resolution, origin, algorithm;
};

// Adds the options to a command. Parsing checks each option by itself.
void AddPixelizeOptions(CLI::App& command, PixelizeWords& words);

// What the words mean together. Throws CLI::ValidationError, as parsing does: a named lattice without density, an
// output twice, or in the place of the input.
PixelizeOptions Interpret(const PixelizeWords& words);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_PIXELIZE_OPTIONS_H_
