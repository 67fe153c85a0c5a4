// URLs among the words of a command or the values of a job.
#ifndef LATVOX_CLIENT_TOOL_CLI_REMOTE_NAMES_H_
#define LATVOX_CLIENT_TOOL_CLI_REMOTE_NAMES_H_

#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/tool/remote/remote_name.h"

namespace latvox::client {

// The files of a job that are on other machines.
struct RemoteNames {
  std::map<std::string, RemoteName> objects;  // by their names, which are among the paths of meshes or the outputs
  bool allow_http = false;
};

// Replaces each URL among the words, paths of meshes, by its name, and keeps it in `remote`. Errors name field and
// value: as ParseRemote; INVALID_ARGUMENT: two URLs differ only in their queries.
absl::Status NameRemotes(std::vector<std::string>& words, RemoteNames& remote);

// Does the same for outputs. Errors: INVALID_ARGUMENT also for a format of two files.
absl::Status NameRemoteOutputs(std::vector<std::string>& words, RemoteNames& remote);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_REMOTE_NAMES_H_
