#include "client/mesh_files/decode.h"

#include <zlib.h>

#include <algorithm>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/stl_file.h"
#include "client/mesh_files/utf16.h"

namespace latvox::client {
namespace {

constexpr absl::string_view kGzip = "\x1f\x8b";

// Appends what one packed member at the front of `rest` holds, and takes the member off.
absl::Status UnpackMember(absl::string_view& rest, uint64_t most, std::string& out) {
  constexpr int kGzipOnly = 16 + MAX_WBITS;
  constexpr size_t kPiece = size_t{1} << 30;  // zlib counts in 32 bits
  z_stream stream{};
  if (inflateInit2(&stream, kGzipOnly) != Z_OK) return absl::ResourceExhaustedError("no memory to unpack gzip");
  const absl::Cleanup end = [&stream] { inflateEnd(&stream); };
  std::string piece(size_t{1} << 18, '\0');
  for (int code = Z_OK; code != Z_STREAM_END;) {
    const size_t given = std::min(rest.size(), kPiece);
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(rest.data()));
    stream.avail_in = static_cast<uInt>(given);
    stream.next_out = reinterpret_cast<Bytef*>(piece.data());
    stream.avail_out = static_cast<uInt>(piece.size());
    code = inflate(&stream, Z_NO_FLUSH);
    if (code == Z_BUF_ERROR) return Bad("gzip data are cut short");
    if (code != Z_OK && code != Z_STREAM_END) {
      return Bad("gzip data are damaged (", stream.msg != nullptr ? stream.msg : zError(code), ")");
    }
    rest.remove_prefix(given - stream.avail_in);
    out.append(piece, 0, piece.size() - stream.avail_out);
    if (out.size() > most) {
      return absl::ResourceExhaustedError(absl::StrCat("gzip data unpack to more than the limit of ", most, " bytes"));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<std::string> Unpack(absl::string_view rest, uint64_t most, std::vector<Warning>& warnings) {
  std::string out;
  while (absl::StartsWith(rest, kGzip)) {
    if (auto status = UnpackMember(rest, most, out); !status.ok()) return status;
  }
  if (!rest.empty()) {
    warnings.push_back({"TRAILING_DATA", absl::StrCat(rest.size(), " bytes after the gzip data are ignored"), ""});
  }
  return out;
}

}  // namespace

absl::StatusOr<std::string> Decode(std::string bytes, std::vector<Warning>& warnings, uint64_t most) {
  if (absl::StartsWith(bytes, kGzip) && !IsBinaryStl(bytes)) {
    auto unpacked = Unpack(bytes, most, warnings);
    if (!unpacked.ok()) return unpacked;
    bytes = *std::move(unpacked);
  }
  const bool little = absl::StartsWith(bytes, "\xFF\xFE"), big = absl::StartsWith(bytes, "\xFE\xFF");
  if ((little || big) && !IsBinaryStl(bytes)) return Utf8OfUtf16(absl::string_view(bytes).substr(2), big);
  return bytes;
}

}  // namespace latvox::client
