// The subcommands of latvox_faults. Each function adds a subcommand and its options to the program. A chosen subcommand
// stores its work in `run`, which returns the exit status.
#ifndef LATVOX_TESTS_FAULTS_COMMANDS_H_
#define LATVOX_TESTS_FAULTS_COMMANDS_H_

#include <CLI/App.hpp>
#include <functional>

namespace latvox::faults {

using Command = std::function<int()>;

// Many clients of all kinds, each a process.
void AddSwarm(CLI::App& program, Command& run);
// Many nearly right requests, and their outcomes.
void AddMutate(CLI::App& program, Command& run);
// Calls that are cancelled in a chosen stage, and the times of cancellation.
void AddCancel(CLI::App& program, Command& run);
// One job through the server and within this process, in turns.
void AddOverhead(CLI::App& program, Command& run);
// Meshes for all of these.
void AddMesh(CLI::App& program, Command& run);

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_COMMANDS_H_
