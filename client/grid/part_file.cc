#include "client/grid/part_file.h"

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/grid/grid_frame.h"
#include "client/grid/grid_reading.h"
#include "client/internal/printable.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

constexpr int64_t kLeafBytes = 140;

bool IsBand(const FrameGrid& grid) {
  return grid.type == openvdb::FloatGrid::gridType() && grid.name == NameOf(Field::kDistance);
}

// Refuses what OpenVDB's own reader does not check. Returns the first grid.
const FrameGrid& CheckFrame(const GridFrame& frame) {
  if (frame.grids.empty()) throw std::runtime_error("it holds no grid");
  const FrameGrid& grid = frame.grids.front();
  if (grid.type != openvdb::BoolGrid::gridType() && !IsBand(grid)) {
    throw std::runtime_error(absl::StrCat("its first grid is a ", Printable(grid.type)));
  }
  if (grid.transform == openvdb::math::NonlinearFrustumMap::mapType()) {
    throw std::runtime_error("its transform is not affine");
  }
  return grid;
}

// Reads the value from bytes in memory, where no length can lead OpenVDB beyond them.
openvdb::Metadata::Ptr ToMetadata(const FrameMetadata& metadata) {
  const auto size = static_cast<openvdb::Index32>(metadata.value.size());
  std::istringstream bytes(std::string(reinterpret_cast<const char*>(&size), sizeof(size)) + metadata.value);
  const openvdb::Metadata::Ptr value = openvdb::Metadata::createMetadata(metadata.type);
  value->read(bytes);
  return value;
}

// The places of the grid's sections, which io::File reads when it opens a file, and does not show.
struct Frame : openvdb::io::Archive {
  openvdb::io::GridDescriptor descriptor;
  openvdb::GridBase::Ptr grid;

  // Precondition: `first` is the result of CheckFrame.
  void Read(std::istream& in, const FrameGrid& first) {
    in.seekg(0);
    readHeader(in);
    setFormatVersion(in);
    setLibraryVersion(in);
    openvdb::MetaMap().readMeta(in);
    readGridCount(in);
    grid = descriptor.read(in);
    grid->clearMetadata();
    for (const FrameMetadata& each : first.metadata) {
      if (each.type != kDelayedLoadType) grid->insertMeta(each.name, *ToMetadata(each));
    }
    in.seekg(static_cast<std::streamoff>(first.transform_at));
    grid->readTransform(in);
  }
};

std::string DigestIn(const openvdb::GridBase& grid) {
  const auto digest = grid.getMetadata<openvdb::StringMetadata>("latvox_digest");
  if (!digest) throw std::runtime_error("its metadata has no latvox_digest");
  return digest->value();
}

}  // namespace

absl::Status PartFile::OpenStream() {
  std::error_code error;
  if (std::filesystem::is_directory(path_, error)) {
    return absl::InvalidArgumentError(absl::StrCat(path_, ": is a directory"));
  }
  file_.rdbuf()->pubsetbuf(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
  errno = 0;
  file_.open(path_, std::ios::binary);
  if (file_.is_open()) return absl::OkStatus();
  const std::string message = absl::StrCat(path_, ": cannot be opened (", std::strerror(errno), ")");
  if (errno == ENOENT) return absl::NotFoundError(absl::StrCat(path_, ": no such file"));
  if (errno == EMFILE) return absl::ResourceExhaustedError(absl::StrCat(message, "; ulimit -n is the limit"));
  return absl::InvalidArgumentError(message);
}

void PartFile::ReadFrame() {
  file_.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
  const GridFrame all = ReadGridFrame(file_, std::filesystem::file_size(path_));
  const FrameGrid& first = CheckFrame(all);
  has_fields_ = IsBand(first) || all.grids.size() > 1;
  Frame frame;
  frame.Read(file_, first);
  grid_ = frame.grid;
  if (!IsAffine(grid_->transform())) throw std::runtime_error("its transform is not affine and finite");
  recorded_ = DigestIn(*grid_);
  if (has_fields_) return;
  leaves_begin_ = frame.descriptor.getBlockPos();
  const int64_t bytes = frame.descriptor.getEndPos() - leaves_begin_;
  if (bytes % kLeafBytes != 0) {
    throw std::runtime_error("its grid does not lie within it");
  }
  leaves_ = static_cast<uint64_t>(bytes / kLeafBytes);
}

absl::StatusOr<std::unique_ptr<PartFile>> PartFile::Open(const std::string& path) {
  openvdb::initialize();
  std::unique_ptr<PartFile> part(new PartFile(path));
  if (auto status = part->OpenStream(); !status.ok()) return status;
  std::string why;
  try {
    part->ReadFrame();
    part->Rewind();
    return part;
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat(path, ": not enough memory to read it"));
  } catch (const std::ios_base::failure&) {
    why = "it is cut short";
  } catch (const std::exception& error) {
    why = Printable(error.what());
  }
  return absl::InvalidArgumentError(absl::StrCat(path, ": is not a whole .vdb file that latvox wrote (", why, ")"));
}

void PartFile::Rewind() {
  if (!status_.ok()) return;
  read_ = 0;
  place_.reset();
  digest_ = Digest();
  file_.seekg(leaves_begin_);
}

const Leaf* PartFile::Next() {
  if (!status_.ok()) return nullptr;
  try {
    if (read_ == leaves_) return CheckDigest(), nullptr;
    ReadLeaf();
    return &leaf_;
  } catch (const std::bad_alloc&) {
    status_ = absl::ResourceExhaustedError(absl::StrCat(path_, ": not enough memory to read it"));
  } catch (const std::ios_base::failure&) {
    status_ = absl::InvalidArgumentError(absl::StrCat(path_, ": cannot be read to its end"));
  } catch (const std::exception& error) {
    status_ = absl::InvalidArgumentError(absl::StrCat(path_, ": ", Printable(error.what())));
  }
  return nullptr;
}

void PartFile::ReadLeaf() {
  leaf_.readBuffers(file_, /*fromHalf=*/false);
  ++read_;
  const TreePlace place = PlaceOf(leaf_.origin());
  const bool mask_is_values =
      std::memcmp(leaf_.buffer().data(), &leaf_.getValueMask().getWord<openvdb::Index64>(0), sizeof(Brick::mask)) == 0;
  const bool aligned = (leaf_.origin() & int32_t{Leaf::DIM - 1}) == openvdb::Coord(0);
  if (!mask_is_values || !aligned || leaf_.isEmpty() || (place_ && place <= *place_)) {
    throw std::runtime_error(absl::StrCat("is damaged: brick ", read_, " of ", leaves_, " is not as latvox wrote it"));
  }
  place_ = place;
  digest_.Add(ToBrick(leaf_));
}

void PartFile::CheckDigest() {
  if (const std::string found = digest_.ToHex(); found != recorded_) {
    throw std::runtime_error(
        absl::StrCat("is damaged: its voxels have digest ", found, ", but latvox_digest is ", recorded_));
  }
}

}  // namespace latvox::client
