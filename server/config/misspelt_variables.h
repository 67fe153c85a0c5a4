// Environment variables that look like options of latvoxd, and are none.
#ifndef LATVOX_SERVER_CONFIG_MISSPELT_VARIABLES_H_
#define LATVOX_SERVER_CONFIG_MISSPELT_VARIABLES_H_

#include <string>
#include <vector>

#include "deploy/manual/command_parser.h"

namespace latvox {

struct MisspeltVariable {
  std::string name, nearest;  // both with LATVOX_
};

// Those of the environment. Other programs have variables that begin with LATVOX_, too, and Kubernetes makes some for a
// Service of the name latvox: what is not like the name of any option is none of these.
std::vector<MisspeltVariable> MisspeltVariables(const std::vector<OptionState>& options);

}  // namespace latvox

#endif  // LATVOX_SERVER_CONFIG_MISSPELT_VARIABLES_H_
