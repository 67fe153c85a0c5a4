#include "client/grid/grid_file.h"

#define XXH_INLINE_ALL
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <xxhash.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <new>
#include <streambuf>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace latvox::client {
namespace {

constexpr size_t kBufferBytes = size_t{1} << 20;

// The header of a .vdb: magic number, four numbers of versions and offsets in 13 bytes, then the file's UUID as text.
constexpr size_t kUuidAt = 21, kUuidBytes = 36;

// Passes all bytes on, and hashes those after the header in the order of writing.
class HashedSink final : public std::streambuf {
 public:
  explicit HashedSink(std::streambuf& sink) : sink_(sink) { XXH3_128bits_reset(&state_); }

  // Returns a UUID of version 8: 122 bits are free for everybody's own use.
  std::string Uuid() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(&state_);
    constexpr uint64_t kVersion = 8, kVariant = uint64_t{2} << 62;
    const uint64_t high = (hash.high64 & ~uint64_t{0xF000}) | kVersion << 12, low = hash.low64 >> 2 | kVariant;
    return absl::StrFormat("%08x-%04x-%04x-%04x-%012x", high >> 32, high >> 16 & 0xFFFF, high & 0xFFFF, low >> 48,
                           low & 0xFFFFFFFFFFFF);
  }

 protected:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    const auto size = static_cast<size_t>(count), header = std::min(size, kUuidAt + kUuidBytes - passed_);
    XXH3_128bits_update(&state_, bytes + header, size - header);
    passed_ += header;
    return sink_.sputn(bytes, count);
  }
  int_type overflow(int_type c) override {
    const char byte = traits_type::to_char_type(c);
    return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
  }
  pos_type seekoff(off_type offset, std::ios::seekdir from, std::ios::openmode which) override {
    return sink_.pubseekoff(offset, from, which);
  }
  pos_type seekpos(pos_type position, std::ios::openmode which) override { return sink_.pubseekpos(position, which); }
  int sync() override { return sink_.pubsync(); }

 private:
  std::streambuf& sink_;
  XXH3_state_t state_;
  size_t passed_ = 0;  // bytes of the header
};

// io::File does not check whether its stream took everything: on a full disk it leaves half a file without an error.
// Archive::write is not used either, because it needs all grids at once. It sets the same flags of the stream, and
// writes the same bytes.
struct Writer : openvdb::io::Archive {
  // OpenVDB gives each file a random UUID. Its readers compare it to tell other content, so the content's own hash does
  // as well, and equal jobs make equal files.
  void Write(const openvdb::GridCPtrVec& grids, const LateGrids& late, std::ofstream& file) const {
    HashedSink sink(*file.rdbuf());
    std::ostream out(&sink);
    out.exceptions(std::ios::failbit | std::ios::badbit);
    openvdb::io::setWriteGridStatsMetadata(out, isGridStatsMetadataEnabled());
    writeHeader(out, /*seekable=*/true);
    openvdb::MetaMap().writeMeta(out);
    const auto count = static_cast<int32_t>(grids.size() + late.count);
    out.write(reinterpret_cast<const char*>(&count), sizeof(count));
    ForEachGrid(grids, late, [&](const openvdb::GridBase::ConstPtr& grid) {
      openvdb::io::setDataCompression(out, compression());  // writeGrid changes it
      openvdb::io::GridDescriptor descriptor(grid->getName(), grid->type(), grid->saveFloatAsHalf());
      writeGrid(descriptor, grid, out, /*seekable=*/true);
    });
    file.seekp(kUuidAt);
    file << sink.Uuid();
  }
};

}  // namespace

absl::Status WriteGridFile(const openvdb::GridCPtrVec& grids, const std::string& path, const LateGrids& late) {
  const auto cannot = [&path](const char* why) {
    return absl::UnknownError(absl::StrCat(path, ": cannot be written (", why, ")"));
  };
  try {
    std::vector<char> buffer(kBufferBytes);
    std::ofstream file;
    file.rdbuf()->pubsetbuf(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    errno = 0;
    file.open(path, std::ios::binary | std::ios::trunc);
    file.exceptions(std::ios::failbit | std::ios::badbit);
    Writer().Write(grids, late, file);
    file.close();
    return absl::OkStatus();
  } catch (const std::ios_base::failure&) {
    return cannot(std::strerror(errno));  // the exception has only the library's message
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat(path, ": not enough memory to write the grid"));
  } catch (const std::exception& error) {
    return cannot(error.what());
  }
}

}  // namespace latvox::client
