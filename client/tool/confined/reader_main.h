// The process that reads a foreign file.
#ifndef LATVOX_CLIENT_TOOL_CONFINED_READER_MAIN_H_
#define LATVOX_CLIENT_TOOL_CONFINED_READER_MAIN_H_

namespace latvox::client {

// What such a process sends.
inline constexpr char kReadInfo[] = "info", kReadVoxels[] = "voxels", kReadContent[] = "content", kReadHdf5[] = "hdf5";

// Returns whether ReaderProcess started this process. Programs that read foreign files ask first in main(), and then
// call EndAsUsual of deploy/process and ReadForParent.
bool IsReader(int argc, char** argv);

// Reads the file, sends the result, and ends the process.
[[noreturn]] void ReadForParent(char** argv);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CONFINED_READER_MAIN_H_
