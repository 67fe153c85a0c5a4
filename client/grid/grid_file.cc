#include "client/grid/grid_file.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>

#include <algorithm>
#include <cstdint>
#include <ostream>
#include <string>

#include "client/grid/file_uuid.h"
#include "client/grid/new_file.h"
#include "client/grid/passing_sink.h"

namespace latvox::client {
namespace {

// Passes all bytes on, and hashes those after the header in the order of writing.
class HashedSink final : public PassingSink {
 public:
  explicit HashedSink(std::streambuf& sink) : PassingSink(sink) {}

  std::string Uuid() const { return uuid_.Text(); }

 protected:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    const auto size = static_cast<size_t>(count), header = std::min(size, kUuidAt + kUuidBytes - passed_);
    uuid_.Add(bytes + header, size - header);
    passed_ += header;
    return sink_.sputn(bytes, count);
  }

 private:
  FileUuid uuid_;
  size_t passed_ = 0;  // bytes of the header
};

// io::File does not check whether its stream took everything: on a full disk it leaves half a file without an error.
// Archive::write is not used either, because it needs all grids at once. It sets the same flags of the stream, and
// writes the same bytes.
struct Writer : openvdb::io::Archive {
  void Write(const openvdb::GridCPtrVec& grids, const LateGrids& late, std::ostream& file) const {
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

absl::Status WriteGridFile(const openvdb::GridCPtrVec& grids, const std::string& path, const LateGrids& late,
                           const Cancellation& cancellation) {
  return WriteNewFile(path, cancellation, [&](std::ostream& file) { Writer().Write(grids, late, file); });
}

}  // namespace latvox::client
