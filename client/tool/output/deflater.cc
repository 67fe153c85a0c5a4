#include "client/tool/output/deflater.h"

#include <zlib.h>

#include <array>

#include "absl/strings/str_cat.h"

namespace latvox::client {

struct Deflater::Stream {
  z_stream z = {};
  bool good = false;
};

Deflater::Deflater(AtomicFile& file, Form form) : file_(file), stream_(std::make_unique<Stream>()) {
  constexpr int kWindowBits = 15, kMemoryLevel = 8;
  constexpr int kGzip = 16;  // added to the window's bits
  const int bits = form == Form::kGzip ? kWindowBits + kGzip : kWindowBits;
  stream_->good = deflateInit2(&stream_->z, Z_BEST_SPEED, Z_DEFLATED, bits, kMemoryLevel, Z_DEFAULT_STRATEGY) == Z_OK;
}

Deflater::~Deflater() {
  if (stream_->good) deflateEnd(&stream_->z);
}

absl::Status Deflater::Run(std::string_view bytes, int flush) {
  if (!stream_->good) return absl::ResourceExhaustedError(absl::StrCat(file_.target(), ": no memory to compress it"));
  std::array<char, size_t{1} << 16> out;
  z_stream& z = stream_->z;
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib does not write there
  z.avail_in = static_cast<uInt>(bytes.size());
  do {
    z.next_out = reinterpret_cast<Bytef*>(out.data());
    z.avail_out = out.size();
    deflate(&z, flush);
    const size_t count = out.size() - z.avail_out;
    bytes_ += count;
    if (auto status = file_.Append({out.data(), count}); !status.ok()) return status;
  } while (z.avail_out == 0);
  return absl::OkStatus();
}

absl::Status Deflater::Append(std::string_view bytes) {
  constexpr size_t kMost = size_t{1} << 30;  // zlib counts with 32 bits
  for (; bytes.size() > kMost; bytes.remove_prefix(kMost)) {
    if (auto status = Run(bytes.substr(0, kMost), Z_NO_FLUSH); !status.ok()) return status;
  }
  return Run(bytes, Z_NO_FLUSH);
}

absl::Status Deflater::Finish() { return Run({}, Z_FINISH); }

}  // namespace latvox::client
