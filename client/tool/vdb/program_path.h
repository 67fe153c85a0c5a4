// The path of the program latvox, which other files lie near.
#ifndef LATVOX_CLIENT_TOOL_VDB_PROGRAM_PATH_H_
#define LATVOX_CLIENT_TOOL_VDB_PROGRAM_PATH_H_

#include <string>

namespace latvox::client {

// Returns the path that SetProgramPath stated, or else that of this process's program.
const std::string& ProgramPath();

// States the path, for a process with another program, such as Python's. Call it before all else of the tool.
void SetProgramPath(const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_VDB_PROGRAM_PATH_H_
