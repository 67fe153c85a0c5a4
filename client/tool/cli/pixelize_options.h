// The options of `latvox pixelize`.
#ifndef LATVOX_CLIENT_TOOL_CLI_PIXELIZE_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_PIXELIZE_OPTIONS_H_

#include <string>
#include <vector>

#include "client/tool/cli/session.h"
#include "deploy/manual/command_parser.h"
#include "latvox/plane_types.h"

namespace latvox::client {

struct PixelizeOptions {
  std::string input;
  std::vector<std::string> outputs;
  PixelizeRequest request;  // all but the polylines
  bool json = false;
  ServerChoice server;
};

// The words as they are given; parsing writes into them.
struct PixelizeWords {
  PixelizeOptions options;  // filled in part by parsing
  std::string lattice, basis, pixel_size, resolution, origin, algorithm;
};

// Adds the options to a command. Parsing checks each option by itself.
void AddPixelizeOptions(CommandParser& command, PixelizeWords& words);

// What the words mean together. Throws UsageError, as parsing does: a named lattice without density, an
// output twice, or in the place of the input.
PixelizeOptions Interpret(const PixelizeWords& words);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_PIXELIZE_OPTIONS_H_
