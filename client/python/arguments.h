// Keyword arguments of Python as the tool's options.
#ifndef LATVOX_CLIENT_PYTHON_ARGUMENTS_H_
#define LATVOX_CLIENT_PYTHON_ARGUMENTS_H_

#include <pybind11/pybind11.h>

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tool/cli/convert_command.h"
#include "client/tool/cli/merge_command.h"
#include "client/tool/cli/voxelize_options.h"

namespace latvox::client::python {

// Returns the keyword arguments: the long options of `latvox voxelize`, with _ in place of -. Each has a dict with
// "help", "value" (the name of its value, "" for a flag), "standard" (its default), and "scope": "request";
// "connection", for the choice of the server; or "call", for other options of calls.
pybind11::dict Keywords();

// Returns the options that the keywords mean together, for a mesh from these files. None is an absent keyword. The same
// checks apply as on the command line. Throws TypeError for a name that is no option, and for a value that is neither
// a text, number or path nor a sequence of these. Errors: INVALID_ARGUMENT naming keyword, value and limit.
absl::StatusOr<VoxelizeOptions> ParseKeywords(const pybind11::dict& keywords, const std::vector<std::string>& paths);

// Likewise those of `latvox convert` for this file.
absl::StatusOr<ConvertOptions> ParseConvertKeywords(const pybind11::dict& keywords, const std::string& path);

// Returns the words of `latvox merge --json`, checked as on the command line. Errors: INVALID_ARGUMENT.
absl::StatusOr<MergeWords> ParseMergeWords(const std::vector<std::string>& parts, const std::string& out);

// Returns a text of the tool with keywords in place of options, and the function in place of the command that it names:
// "voxel_size" in place of "--voxel-size".
std::string WithKeywords(const std::string& text);

}  // namespace latvox::client::python

#endif  // LATVOX_CLIENT_PYTHON_ARGUMENTS_H_
