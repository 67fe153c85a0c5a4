// The options of `latvox batch`.
#ifndef LATVOX_CLIENT_TOOL_CLI_BATCH_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_BATCH_OPTIONS_H_

#include <string>

#include "client/tool/cli/session.h"
#include "client/tool/cli/worker.h"
#include "deploy/manual/command_parser.h"

namespace latvox::client {

// Jobs at once, unless --jobs says. A private server shares this machine's cores with the reading and encoding of
// meshes; servers elsewhere have cores of their own.
inline constexpr int kPrivateJobs = 2, kServerJobs = 4;

struct BatchOptions {
  std::string jobs_file, directory;
  ChosenWorker worker;
  int jobs = 0;  // at once
  bool resume = false, json = false;
  ServerChoice server;  // whose timeout is each job's
};

// The words as they are given; parsing writes into them.
struct BatchWords {
  BatchOptions options;  // filled in part by parsing; jobs is 0 if it was not given
  std::string worker;
};

// Adds the options to a command. Parsing checks each option by itself.
void AddBatchOptions(CommandParser& command, BatchWords& words);

// What the words mean together with the environment. Throws UsageError, as ChooseWorker.
BatchOptions Interpret(const BatchWords& words);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_BATCH_OPTIONS_H_
