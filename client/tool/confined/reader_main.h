// The process that reads a foreign file.
#ifndef LATVOX_CLIENT_TOOL_CONFINED_READER_MAIN_H_
#define LATVOX_CLIENT_TOOL_CONFINED_READER_MAIN_H_

namespace latvox::client {

// The words for the content that such a process sends.
inline constexpr char kReadInfo[] = "info", kReadVoxels[] = "voxels", kReadContent[] = "content", kReadHdf5[] = "hdf5";

// Returns whether ReaderProcess started this process. Programs that read foreign files ask first in main(), and then
// call ReadForParent.
bool IsReader(int argc, char** argv);

// Reads the file, sends the result, and ends the process. Calls `when_loaded` when all libraries are loaded: a program
// that calls EndOrderlyWhenExhausted gives EndAsUsual, because a process without rights may not ask what has run out.
[[noreturn]] void ReadForParent(char** argv, void (*when_loaded)());

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CONFINED_READER_MAIN_H_
