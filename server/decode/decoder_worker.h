// A decoder process, seen from inside: the server's own program, started anew by DecoderProcess.
#ifndef LATVOX_SERVER_DECODE_DECODER_WORKER_H_
#define LATVOX_SERVER_DECODE_DECODER_WORKER_H_

#include <optional>

namespace latvox {

// The first argument that makes the program a decoder process; it is not for people. Three more follow: the server's
// process id, the bytes that a decode may take, and "confined". "unconfined" instead allows a process without
// confinement where the system does not support it.
inline constexpr char kDecoderArgument[] = "--decoder-process";

// The file descriptor of its end of the socket.
inline constexpr int kDecoderChannel = 3;

// If the arguments say so, decodes meshes until the server hangs up, and returns the exit status. Call it first in
// main, before there is a second thread, an open file or a secret in memory.
std::optional<int> RunIfDecoderProcess(int argc, const char* const* argv);

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DECODER_WORKER_H_
