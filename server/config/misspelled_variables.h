// Finds environment variables that look like misspelled options of latvoxd.
#ifndef LATVOX_SERVER_CONFIG_MISSPELLED_VARIABLES_H_
#define LATVOX_SERVER_CONFIG_MISSPELLED_VARIABLES_H_

#include <string>
#include <vector>

#include "deploy/manual/command_parser.h"

namespace latvox {

struct MisspelledVariable {
  std::string name, nearest;  // both with LATVOX_
};

// Returns those of the environment. Other programs have variables that begin with LATVOX_, too, and Kubernetes makes
// some for a Service named latvox. A variable unlike all options is ignored.
std::vector<MisspelledVariable> MisspelledVariables(const std::vector<OptionState>& options);

}  // namespace latvox

#endif  // LATVOX_SERVER_CONFIG_MISSPELLED_VARIABLES_H_
