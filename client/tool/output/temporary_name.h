// Names of unfinished files beside their targets.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_TEMPORARY_NAME_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_TEMPORARY_NAME_H_

#include <filesystem>
#include <functional>
#include <string>

namespace latvox::client {

// Gives a locked file a name `.latvox-TARGET-KERNEL-N.part` beside the target, with the first free number N. TARGET is
// a hash, because the target's own name may have the greatest length already. The same target has the same names, so
// the next writer of a target removes what dead writers of it left, without a search.
//   make   makes the name: returns false, with errno set, if it cannot; EEXIST asks for another name
// Returns "", with errno set, if there is no such name.
std::string TakeTemporaryName(const std::filesystem::path& target, const std::function<bool(const std::string&)>& make);

// Removes the unfinished files that dead processes left in the directory.
void RemoveAbandonedFiles(const std::string& directory);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_TEMPORARY_NAME_H_
