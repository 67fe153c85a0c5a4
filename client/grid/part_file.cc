#include "client/grid/part_file.h"

#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/grid/grid_frame.h"
#include "client/grid/nano_names.h"
#include "client/grid/open_file.h"
#include "client/internal/printable.h"

namespace latvox::client {

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

absl::StatusOr<std::unique_ptr<PartFile>> PartFile::Open(const std::string& path) {
  openvdb::initialize();
  std::unique_ptr<PartFile> part(new PartFile(path));
  if (auto status = part->OpenStream(); !status.ok()) return status;
  const uint64_t magic = ReadMagic(part->file_);
  const bool is_nano = IsNanoMagic(magic);
  if (!is_nano && magic != kVdbMagic) {
    return absl::InvalidArgumentError(
        absl::StrCat(path,
                     ": is not a whole .vdb or .nvdb file that latvox wrote, as parts must be; latvox convert writes "
                     "the whole in other formats"));
  }
  std::string why;
  try {
    part->file_.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
    part->frame_ = is_nano ? ReadNanoPart(part->file_) : ReadVdbPart(part->file_, std::filesystem::file_size(path));
    part->Rewind();
    return part;
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat(path, ": not enough memory to read it"));
  } catch (const std::ios_base::failure&) {
    why = "it is cut short";
  } catch (const std::exception& error) {
    why = Printable(error.what());
  }
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": is not a whole ", is_nano ? ".nvdb" : ".vdb", " file that latvox wrote (", why, ")"));
}

void PartFile::Rewind() {
  if (!status_.ok()) return;
  read_ = 0;
  place_.reset();
  digest_ = Digest();
  file_.seekg(static_cast<std::streamoff>(frame_.leaves_at));
}

const Leaf* PartFile::Next() {
  if (!status_.ok()) return nullptr;
  try {
    if (read_ == frame_.leaves) {
      CheckDigest();
      return nullptr;
    }
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
  if (frame_.is_nano) {
    ReadNanoLeaf(file_, leaf_);
  } else {
    ReadVdbLeaf(file_, leaf_);
  }
  ++read_;
  const TreePlace place = PlaceOf(leaf_.origin());
  const bool mask_is_values =
      std::memcmp(leaf_.buffer().data(), &leaf_.getValueMask().getWord<openvdb::Index64>(0), sizeof(Brick::mask)) == 0;
  const bool aligned = (leaf_.origin() & int32_t{Leaf::DIM - 1}) == openvdb::Coord(0);
  if (!mask_is_values || !aligned || leaf_.isEmpty() || (place_ && place <= *place_)) {
    throw std::runtime_error(
        absl::StrCat("is damaged: brick ", read_, " of ", frame_.leaves, " is not as latvox wrote it"));
  }
  place_ = place;
  digest_.Add(ToBrick(leaf_));
}

void PartFile::CheckDigest() {
  if (const std::string found = digest_.ToHex(); found != frame_.digest) {
    throw std::runtime_error(
        absl::StrCat("is damaged: its voxels have digest ", found, ", but latvox_digest is ", frame_.digest));
  }
}

}  // namespace latvox::client
