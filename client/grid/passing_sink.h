// Streams that pass bytes on. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_PASSING_SINK_H_
#define LATVOX_CLIENT_GRID_PASSING_SINK_H_

#include <algorithm>
#include <cerrno>
#include <ios>
#include <streambuf>

#include "absl/status/status.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// Returns CANCELLED or OK.
inline absl::Status CheckGoesOn(const Cancellation& cancellation) {
  return cancellation.cancelled() ? absl::CancelledError("cancelled") : absl::OkStatus();
}

// Passes on what xsputn, of the derived class, lets through.
class PassingSink : public std::streambuf {
 public:
  explicit PassingSink(std::streambuf& sink) : sink_(sink) {}  // which outlives this

 protected:
  int_type overflow(int_type c) override {
    const char byte = traits_type::to_char_type(c);
    return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
  }
  pos_type seekoff(off_type offset, std::ios::seekdir from, std::ios::openmode which) override {
    return sink_.pubseekoff(offset, from, which);
  }
  pos_type seekpos(pos_type position, std::ios::openmode which) override { return sink_.pubseekpos(position, which); }
  int sync() override { return sink_.pubsync(); }

  std::streambuf& sink_;
};

// Passes all bytes on, a piece at a time, until the call is cancelled. From then on it takes none, so that its stream
// fails. OpenVDB and NanoVDB look at nothing else while they write. `error` gets the system's error, because the thread
// that writes may be another one than the caller's.
class StoppableSink final : public PassingSink {
 public:
  StoppableSink(std::streambuf& sink, const Cancellation& cancellation, int& error)
      : PassingSink(sink), cancellation_(cancellation), error_(error) {}

 protected:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    constexpr std::streamsize kPiece = 1 << 20;
    std::streamsize passed = 0;
    while (passed < count && !cancellation_.cancelled()) {
      const std::streamsize now = sink_.sputn(bytes + passed, std::min(kPiece, count - passed));
      if (now <= 0) {
        error_ = errno;
        break;
      }
      passed += now;
    }
    return passed;
  }

 private:
  const Cancellation& cancellation_;
  int& error_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_PASSING_SINK_H_
