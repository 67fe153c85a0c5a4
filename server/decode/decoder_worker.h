// A decoder process, from inside: the server's own program, started anew by DecoderProcess.
#ifndef LATVOX_SERVER_DECODE_DECODER_WORKER_H_
#define LATVOX_SERVER_DECODE_DECODER_WORKER_H_

#include <optional>

namespace latvox {

// The first argument that makes the program a decoder process; not for people. Then follow the server's process id, the
// bytes that a decode may take, and "confined" or, if it may do without where the system does
// not allow it, "unconfined".
inline constexpr char kDecoderArgument[] = "--decoder-process";

// The file descriptor of its end of the socket.
inline constexpr int kDecoderChannel = 3;

// If the arguments say so, decodes what comes until the server hangs up, and returns the exit status. Call it first
// thing in main, before there is a second thread, an open file or anything worth stealing.
std::optional<int> RunIfDecoderProcess(int argc, const char* const* argv);

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DECODER_WORKER_H_
