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
  if (frame_.tree) Guard([this] { frame_.tree->Rewind(); });
}

double PartFile::share() const {
  const uint64_t size = frame_.tree->size();
  return size == 0 ? 1 : static_cast<double>(frame_.tree->read()) / static_cast<double>(size);
}

const Brick* PartFile::Next() {
  bool is_there = false;
  if (status_.ok()) Guard([&] { is_there = ReadBrick(); });
  return is_there ? &brick_ : nullptr;
}

template <class Read>
void PartFile::Guard(const Read& read) {
  try {
    read();
  } catch (const std::bad_alloc&) {
    status_ = absl::ResourceExhaustedError(absl::StrCat(path_, ": not enough memory to read it"));
  } catch (const std::ios_base::failure&) {
    status_ = absl::InvalidArgumentError(absl::StrCat(path_, ": cannot be read to its end"));
  } catch (const std::exception& error) {
    status_ = absl::InvalidArgumentError(absl::StrCat(path_, ": ", Printable(error.what())));
  }
}

// Returns false at the end.
bool PartFile::ReadBrick() {
  if (!frame_.tree->Next(brick_)) {
    CheckDigest();
    return false;
  }
  ++read_;
  const TreePlace place = PlaceOf(brick_.brick_ijk);
  if (brick_.mask == BrickMask{} || (place_ && place <= *place_)) {
    throw std::runtime_error(absl::StrCat("is damaged: brick ", read_, " is not as latvox wrote it"));
  }
  place_ = place;
  digest_.Add(brick_);
  return true;
}

void PartFile::CheckDigest() {
  if (const std::string found = digest_.ToHex(); found != frame_.digest) {
    throw std::runtime_error(
        absl::StrCat("is damaged: its voxels have digest ", found, ", but latvox_digest is ", frame_.digest));
  }
}

}  // namespace latvox::client
