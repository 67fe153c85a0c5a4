// latvox_faults: the clients that the fault suite sets on a server. The tests of this folder run it.
#include <CLI/CLI.hpp>

#include "tests/faults/commands.h"

int main(int argc, char** argv) {
  CLI::App program("Clients, good and bad, for the fault suite", "latvox_faults");
  program.require_subcommand(1);
  latvox::faults::Command run;
  latvox::faults::AddSwarm(program, run);
  latvox::faults::AddMutate(program, run);
  latvox::faults::AddCancel(program, run);
  latvox::faults::AddOverhead(program, run);
  latvox::faults::AddMesh(program, run);
  CLI11_PARSE(program, argc, argv);
  return run();
}
