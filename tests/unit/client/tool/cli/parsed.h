// Command lines, parsed as the tool does it.
#ifndef LATVOX_TESTS_UNIT_CLIENT_TOOL_CLI_PARSED_H_
#define LATVOX_TESTS_UNIT_CLIENT_TOOL_CLI_PARSED_H_

#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

#include "client/tool/cli/voxelize_command.h"
#include "client/tool/cli/voxelize_options.h"
#include "deploy/manual/command_parser.h"

namespace latvox::client {

// Parses like the tool. Throws the same exceptions.
inline VoxelizeOptions Parse(std::vector<std::string> arguments) {
  CommandParser parser;
  VoxelizeWords words;
  AddVoxelizeOptions(parser, words);
  arguments.insert(arguments.begin(), {"mesh.obj", "-o", "out.vdb"});
  parser.Parse(std::move(arguments));
  return Interpret(words);
}

inline std::string Refusal(const std::vector<std::string>& arguments) {
  try {
    Parse(arguments);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

// Parses the words as they are, without a mesh and an output before them.
inline std::string RefusalOfAll(std::vector<std::string> words) {
  CommandParser parser("", "latvox");
  VoxelizeWords voxelize;
  AddVoxelizeOptions(parser.AddCommand("voxelize", ""), voxelize);
  parser.AddCommand("view", "");
  try {
    parser.Parse(std::move(words));
    Interpret(voxelize);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

// Expects that the refusal of the arguments contains each text: the option, its value or its limit.
inline void Refuses(const std::vector<std::string>& arguments, const std::vector<std::string>& texts) {
  for (const std::string& text : texts) EXPECT_THAT(Refusal(arguments), testing::HasSubstr(text));
}

}  // namespace latvox::client

#endif  // LATVOX_TESTS_UNIT_CLIENT_TOOL_CLI_PARSED_H_
