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
  PixelizeRequest request;  // without polylines
  bool json = false;
  ServerChoice server;
};

// The words as given. Parsing writes into them.
struct PixelizeWords {
  PixelizeOptions options;  // partly filled by parsing
  std::string lattice, basis, pixel_size, resolution, origin, algorithm;
};

// Adds the options to a command. Parsing checks each option alone.
void AddPixelizeOptions(CommandParser& command, PixelizeWords& words);

// Returns the options that the words mean together. Throws UsageError, as parsing does: a named lattice without a
// density, an output given twice, an output that is the input.
PixelizeOptions Interpret(const PixelizeWords& words);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_PIXELIZE_OPTIONS_H_
