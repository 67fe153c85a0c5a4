#include "server/work/unfinished_uploads.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "absl/time/time.h"
#include "server/base/errors.h"
#include "server/base/milliseconds.h"

namespace latvox {
namespace {

constexpr absl::Duration kUploadRetryDelay = absl::Seconds(1);

// Smaller pieces are copied, so that a mesh sent byte by byte costs no more memory than its bytes.
constexpr size_t kSmallMeshPiece = size_t{64} << 10;

// As in a stream, a trickle of bytes is no progress.
constexpr double kLeastBytesPerMillisecond = 1;

absl::Status WrongOffset(uint64_t offset, uint64_t next) {
  return MakeError(absl::StatusCode::kInvalidArgument,
                   absl::StrCat("offset ", offset, " is beyond the ", next, " bytes that the server has"),
                   {"WRONG_OFFSET", "offset", absl::StrCat(offset), absl::StrCat(next)});
}

absl::Status TooMany(const char* field, absl::string_view what, uint64_t value, uint64_t limit,
                     const char* limit_name) {
  return WithRetry(MakeError(absl::StatusCode::kResourceExhausted,
                             absl::StrCat(field, ": ", value, what, " exceed ", limit, "; try again"),
                             {"TOO_MANY_UPLOADS", field, absl::StrCat(value), absl::StrCat(limit), limit_name}),
                   kUploadRetryDelay);
}

// Returns the number of the piece's bytes that have come before. Precondition: offset is not beyond `bytes`.
absl::StatusOr<size_t> CheckRepeated(const absl::Cord& bytes, const MeshSpec& mesh, uint64_t offset,
                                     absl::string_view piece) {
  if (const uint64_t end = offset + piece.size(); end > mesh.bytes) {
    return BadSpec(absl::StrCat("mesh_bytes ", mesh.bytes, " was declared, but at least ", end, " bytes came"),
                   "mesh_bytes", absl::StrCat(end), absl::StrCat(mesh.bytes));
  }
  const auto repeated = static_cast<size_t>(std::min<uint64_t>(piece.size(), bytes.size() - offset));
  if (bytes.Subcord(offset, repeated) == piece.substr(0, repeated)) return repeated;
  return BadSpec(absl::StrCat("mesh_piece: the bytes from ", offset, " on are not those that came before"),
                 "mesh_piece", absl::StrCat(offset));
}

}  // namespace

UnfinishedUploads::Uploads::iterator UnfinishedUploads::Find(const std::string& client, const MeshSpec& mesh) {
  return std::find_if(uploads_.begin(), uploads_.end(),
                      [&](const auto& upload) { return upload->mesh == mesh && upload->client == client; });
}

UnfinishedUploads::Snapshot UnfinishedUploads::Look(const std::string& client, const MeshSpec& mesh) {
  const std::lock_guard lock(mu_);
  const auto found = Find(client, mesh);
  if (found != uploads_.end()) return {*found, (*found)->bytes, (*found)->raw_mesh};
  return {nullptr, {}, mesh.raw ? std::optional<RawMeshCheck>(*mesh.raw) : std::nullopt};
}

absl::StatusOr<UnfinishedUploads::Progress> UnfinishedUploads::Add(const std::string& client, const MeshSpec& mesh,
                                                                   uint64_t offset, std::string&& piece,
                                                                   Clock::time_point now) {
  for (;;) {
    Snapshot known = Look(client, mesh);
    const uint64_t size = known.bytes.size();
    if (!piece.empty()) {
      if (offset > size) return WrongOffset(offset, size);
      const absl::StatusOr<size_t> repeated = CheckRepeated(known.bytes, mesh, offset, piece);
      absl::Status status = repeated.status();
      if (status.ok()) piece.erase(0, *repeated);
      if (status.ok() && known.raw_mesh) status = known.raw_mesh->Add(piece);
      if (!status.ok()) {
        Drop(known.upload);
        return status;
      }
      offset += *repeated;
    }
    if (piece.empty()) return ProgressOf(known.upload, size);
    const auto progress = Append(known, client, mesh, piece, now);
    if (!progress.ok()) return progress.status();
    // Otherwise, another call was faster, and its bytes are to be compared.
    if (*progress) return **progress;
  }
}

// Returns nothing, and leaves the piece, if the upload is no longer as `known`.
absl::StatusOr<std::optional<UnfinishedUploads::Progress>> UnfinishedUploads::Append(
    const Snapshot& known, const std::string& client, const MeshSpec& mesh, std::string& piece, Clock::time_point now) {
  Uploads dropped;  // destroyed after the lock is released
  const std::lock_guard lock(mu_);
  auto found = Find(client, mesh);
  std::shared_ptr<Upload> upload = found == uploads_.end() ? nullptr : *found;
  const uint64_t size = known.bytes.size() + piece.size();
  if (upload != known.upload || (upload && upload->bytes.size() != known.bytes.size())) return std::nullopt;
  absl::Status status = MakeRoom(&client, upload.get(), piece.size(), now, dropped);
  if (status.ok()) status = MakeRoom(nullptr, upload.get(), piece.size(), now, dropped);
  if (!status.ok()) return status;
  if (!upload) {
    upload = std::make_shared<Upload>(Upload{client, mesh, {}, {}, MemoryReservation(memory_, client), now});
  }
  if (status = upload->memory.Grow(size); !status.ok()) return status;
  piece.size() < kSmallMeshPiece ? upload->bytes.Append(absl::string_view(piece))
                                 : upload->bytes.Append(std::move(piece));
  if (known.raw_mesh) upload->raw_mesh.emplace(*known.raw_mesh);
  if (found == uploads_.end()) {
    uploads_.push_front(upload);
  } else if (static_cast<double>(size - upload->progress_bytes) >=
             kLeastBytesPerMillisecond * Milliseconds(now - upload->progress_at)) {
    upload->progress_at = now;
    upload->progress_bytes = size;
    uploads_.splice(uploads_.begin(), uploads_, found);
  }
  return ProgressOf(upload, size);
}

UnfinishedUploads::Progress UnfinishedUploads::ProgressOf(std::shared_ptr<Upload> upload, uint64_t size) {
  const bool is_complete = upload && size == upload->mesh.bytes;
  return {size, is_complete ? std::move(upload) : nullptr};
}

// Drops idle uploads, of this client or, without one, of all, until `more` bytes fit.
//   growing   the upload that gets them; null: a new one
absl::Status UnfinishedUploads::MakeRoom(const std::string* client, const Upload* growing, uint64_t more,
                                         Clock::time_point now, Uploads& dropped) {
  const uint64_t most_bytes = client == nullptr ? 2 * bytes_of_client_ : bytes_of_client_;
  const size_t most = client == nullptr ? kMost : kMostOfClient;
  const auto counts = [&](const Upload& upload) { return client == nullptr || upload.client == *client; };
  uint64_t bytes = more;
  size_t uploads = growing == nullptr ? 1 : 0;
  for (const auto& upload : uploads_) {
    if (!counts(*upload)) continue;
    bytes += upload->bytes.size();
    ++uploads;
  }
  for (auto it = uploads_.end(); it != uploads_.begin() && (bytes > most_bytes || uploads > most);) {
    const Upload& upload = **--it;
    if (now - upload.progress_at < kShortPatience) break;
    if (&upload == growing || !counts(upload)) continue;
    bytes -= upload.bytes.size();
    --uploads;
    const auto idle = it++;
    dropped.splice(dropped.end(), uploads_, idle);
  }
  const char* const field = client == nullptr ? "uploads" : "uploads_of_client";
  if (uploads > most) return TooMany(field, " unfinished ones", uploads, most, "");
  if (bytes > most_bytes) return TooMany(field, " bytes of unfinished ones", bytes, most_bytes, "mesh_store_bytes");
  return absl::OkStatus();
}

void UnfinishedUploads::Drop(const std::shared_ptr<const Upload>& upload) {
  const std::lock_guard lock(mu_);
  uploads_.remove(std::const_pointer_cast<Upload>(upload));
}

void UnfinishedUploads::DropIdle(std::chrono::nanoseconds patience, Clock::time_point now) {
  Uploads dropped;  // destroyed after the lock is released
  const std::lock_guard lock(mu_);
  while (!uploads_.empty() && now - uploads_.back()->progress_at >= patience) {
    dropped.splice(dropped.end(), uploads_, std::prev(uploads_.end()));
  }
}

uint64_t UnfinishedUploads::bytes() const {
  const std::lock_guard lock(mu_);
  uint64_t bytes = 0;
  for (const auto& upload : uploads_) bytes += upload->bytes.size();
  return bytes;
}

size_t UnfinishedUploads::size() const {
  const std::lock_guard lock(mu_);
  return uploads_.size();
}

}  // namespace latvox
