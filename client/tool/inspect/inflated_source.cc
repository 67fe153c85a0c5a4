#include "client/tool/inspect/inflated_source.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <limits>

#include "absl/strings/str_cat.h"

namespace latvox::client {

struct InflatedSource::Stream {
  z_stream z = {};
  bool good = false, ended = false;
  std::array<char, size_t{1} << 16> packed;
};

InflatedSource::InflatedSource(const std::string& name, ByteSource& packed)
    : ByteSource(name), packed_(packed), stream_(std::make_unique<Stream>()) {
  constexpr int kAnyWindow = 15 + 32;  // either form, as the stream's head says
  stream_->good = inflateInit2(&stream_->z, kAnyWindow) == Z_OK;
}

InflatedSource::~InflatedSource() {
  if (stream_->good) inflateEnd(&stream_->z);
}

absl::StatusOr<size_t> InflatedSource::ReadSome(char* to, size_t count) {
  if (!stream_->good) return absl::ResourceExhaustedError("no memory to read compressed data");
  z_stream& z = stream_->z;
  z.next_out = reinterpret_cast<Bytef*>(to);
  z.avail_out = static_cast<uInt>(std::min<size_t>(count, std::numeric_limits<uInt>::max()));
  const uInt wanted = z.avail_out;
  while (z.avail_out > 0 && !stream_->ended) {
    if (z.avail_in == 0) {
      const auto got = packed_.ReadSome(stream_->packed.data(), stream_->packed.size());
      if (!got.ok()) return got.status();
      if (*got == 0) return Bad("is cut short");
      z.next_in = reinterpret_cast<Bytef*>(stream_->packed.data());
      z.avail_in = static_cast<uInt>(*got);
    }
    const int result = inflate(&z, Z_NO_FLUSH);
    if (result != Z_OK && result != Z_STREAM_END) return Bad("has damaged compressed data");
    if (result != Z_STREAM_END) continue;
    stream_->ended = true;
    if (z.avail_in > 0) return Bad("goes on after its content");
    if (auto status = packed_.CheckEnd(); !status.ok()) return status;
  }
  return wanted - z.avail_out;
}

}  // namespace latvox::client
