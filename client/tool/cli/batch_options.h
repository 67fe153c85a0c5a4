// The options of `latvox batch`.
#ifndef LATVOX_CLIENT_TOOL_CLI_BATCH_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_BATCH_OPTIONS_H_

#include <string>

#include "client/tool/cli/session.h"
#include "client/tool/cli/worker.h"
#include "deploy/manual/command_parser.h"

namespace latvox::client {

// Default number of jobs at once. A private server shares the cores of this machine with the reading and encoding of
// meshes. Other servers have their own cores.
inline constexpr int kPrivateJobs = 2, kServerJobs = 4;

struct BatchOptions {
  std::string jobs_file, directory;
  ChosenWorker worker;
  int jobs = 0;  // at once
  bool resume = false, json = false, allow_http = false;
  ServerChoice server;  // its timeout applies to each job
};

// The words as given. Parsing writes into them.
struct BatchWords {
  BatchOptions options;  // partly filled by parsing; jobs is 0 if not given
  std::string worker;
};

// Adds the options to a command. Parsing checks each option alone.
void AddBatchOptions(CommandParser& command, BatchWords& words);

// Returns the options that the words and the environment mean. Throws UsageError as ChooseWorker.
BatchOptions Interpret(const BatchWords& words);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_BATCH_OPTIONS_H_
