#include "server/work/mesh_upload.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"
#include "server/base/milliseconds.h"

namespace latvox {
namespace {

// Smaller pieces are joined up to this size, so that a mesh sent byte by byte costs no more memory than its bytes.
constexpr size_t kSmallPiece = size_t{64} << 10;

absl::Status WrongLength(absl::string_view relation, uint64_t size, uint64_t declared) {
  return BadSpec(absl::StrCat("mesh_bytes ", declared, " was declared, but ", relation, size, " bytes came"),
                 "mesh_bytes", absl::StrCat(size), absl::StrCat(declared));
}

}  // namespace

absl::Status MeshUpload::Append(std::string&& piece) {
  last_ = std::chrono::steady_clock::now();
  size_ += piece.size();
  if (size_ > limit_) return LimitExceeded("mesh_bytes", size_, limit_);
  if (declared_ != 0 && size_ > declared_) return WrongLength("at least ", size_, declared_);
  if (!pieces_.empty() && pieces_.back().size() + piece.size() <= kSmallPiece) {
    pieces_.back() += piece;
  } else {
    pieces_.push_back(std::move(piece));
  }
  return absl::OkStatus();
}

absl::Status MeshUpload::CheckComplete() const {
  if (declared_ != 0 && size_ != declared_) return WrongLength("only ", size_, declared_);
  if (size_ == 0) return BadMesh("no bytes came");
  return absl::OkStatus();
}

absl::Cord MeshUpload::Release() && {
  absl::Cord all;
  for (std::string& piece : std::exchange(pieces_, {})) all.Append(std::move(piece));
  return all;
}

std::optional<double> MeshUpload::milliseconds() const {
  if (size_ == 0) return std::nullopt;
  return Milliseconds(last_ - began_);
}

}  // namespace latvox
