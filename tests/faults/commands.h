// The subcommands of latvox_faults. Each adds itself and its options to the program, and puts what it does when it is
// chosen into `run`, which returns the exit status.
#ifndef LATVOX_TESTS_FAULTS_COMMANDS_H_
#define LATVOX_TESTS_FAULTS_COMMANDS_H_

#include <CLI/App.hpp>
#include <functional>

namespace latvox::faults {

using Command = std::function<int()>;

// Many clients, each a process, of all kinds.
void AddSwarm(CLI::App& program, Command& run);
// Many nearly right requests, and what came of them.
void AddMutate(CLI::App& program, Command& run);
// Calls that are cancelled in a chosen stage, and when.
void AddCancel(CLI::App& program, Command& run);
// One job through the server and within this process, in turns.
void AddOverhead(CLI::App& program, Command& run);
// Meshes for all of these.
void AddMesh(CLI::App& program, Command& run);

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_COMMANDS_H_
