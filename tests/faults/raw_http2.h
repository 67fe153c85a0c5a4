// HTTP/2 by hand: bytes that no gRPC library would send.
#ifndef LATVOX_TESTS_FAULTS_RAW_HTTP2_H_
#define LATVOX_TESTS_FAULTS_RAW_HTTP2_H_

#include <cstdint>
#include <string>

#include "absl/time/time.h"

namespace latvox::faults {

// A socket to "HOST:PORT" (HOST a number) or "unix:PATH". Nothing throws. After the peer has closed, writes are dropped
// and reads return nothing.
class RawConnection {
 public:
  explicit RawConnection(const std::string& address);
  ~RawConnection();
  RawConnection(const RawConnection&) = delete;
  RawConnection& operator=(const RawConnection&) = delete;

  bool connected() const { return socket_ >= 0; }
  // Gives up once the peer has taken nothing for a second.
  bool Send(const std::string& bytes);
  // Reads and drops until the peer closes (true) or `patience` is over (false).
  bool WaitUntilClosed(absl::Duration patience);
  // Closes with a reset instead of an orderly shutdown.
  void Reset();

 private:
  int socket_ = -1;
};

inline constexpr uint8_t kData = 0, kHeaders = 1, kResetStream = 3, kSettings = 4, kPing = 6, kContinuation = 9;
inline constexpr uint8_t kEndStream = 1, kEndHeaders = 4;

// Returns the beginning of every connection: the preface and empty settings.
std::string Preface();
std::string Frame(uint8_t type, uint8_t flags, uint32_t stream, const std::string& payload);
// Returns one header, not compressed.
std::string Header(const std::string& name, const std::string& value);
// Returns the headers of a gRPC call.
std::string CallHeaders(uint32_t stream, const std::string& method);
// Returns a gRPC message in a DATA frame; shorter than 16,000 bytes.
std::string MessageFrame(uint32_t stream, const std::string& message, bool last);

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_RAW_HTTP2_H_
