// The process that reads a foreign file.
#ifndef LATVOX_CLIENT_TOOL_CONFINED_READER_MAIN_H_
#define LATVOX_CLIENT_TOOL_CONFINED_READER_MAIN_H_

#include <optional>

namespace latvox::client {

// What such a process sends.
inline constexpr char kReadInfo[] = "info", kReadVoxels[] = "voxels", kReadContent[] = "content";

// If ReaderProcess started this process, reads the file, sends the result, and returns the exit status. Programs that
// read foreign files call it first in main().
std::optional<int> ReadForParent(int argc, char** argv);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CONFINED_READER_MAIN_H_
