// Pieces of meshes from several clients, in any order. The uploads are those of a reference: a map of byte strings.
#include <fuzzer/FuzzedDataProvider.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "server/base/errors.h"
#include "server/work/unfinished_uploads.h"

namespace {

using latvox::MeshSpec;
using latvox::RawMeshCheck;
using latvox::UnfinishedUploads;
using Time = UnfinishedUploads::Clock::time_point;
using std::chrono::milliseconds;

constexpr uint64_t kRoom = 100'000;                // of a client
constexpr uint64_t kLarge = 70'000;                // two such meshes of a client do not fit
constexpr auto kAnyTime = milliseconds(700'000);   // some more than the longest patience
constexpr auto kShortTime = milliseconds(20'000);  // and than the shortest

void Require(bool condition) {
  if (!condition) std::abort();
}

MeshSpec MeshOf(uint8_t number) {
  MeshSpec mesh{.digest = {number}, .bytes = number % 8 == 7 ? kLarge : number};
  if (number % 2 == 0) {
    mesh.raw = latvox::RawMeshLayout{.vertices = number % 5u + 1, .triangles = number % 7u + 1};
    mesh.bytes = mesh.raw->bytes();
  }
  return mesh;
}

// Returns the bytes that clients have, except those that they damage. As plain arrays, they are a mesh.
char ByteOf(const MeshSpec& mesh, uint64_t at) { return mesh.raw ? '\0' : static_cast<char>(at * 167 + at / 251); }

std::string PieceOf(const MeshSpec& mesh, uint64_t offset, uint64_t size, FuzzedDataProvider& data) {
  std::string piece(size, '\0');
  for (uint64_t n = 0; n < size; ++n) piece[n] = ByteOf(mesh, offset + n);
  if (size > 0 && data.ConsumeIntegral<uint8_t>() < 16) {
    piece[data.ConsumeIntegralInRange<uint64_t>(0, size - 1)] ^= data.ConsumeIntegral<char>();
  }
  return piece;
}

struct Known {
  std::string bytes;
  Time progress_at;
  uint64_t progress_bytes = 0;
};
using Key = std::pair<std::string, uint8_t>;  // client, mesh

class Uploads {
 public:
  void Add(const Key& key, uint64_t offset, const std::string& piece);
  void Drop(const Key& key) {
    uploads_.Drop(key.first, MeshOf(key.second));
    known_.erase(key);
  }
  void DropIdle(milliseconds patience) {
    uploads_.DropIdle(patience, now_);
    std::erase_if(known_, [&](const auto& each) { return now_ - each.second.progress_at >= patience; });
  }
  void Wait(milliseconds time) { now_ += time; }
  void Check();

  uint64_t size(const Key& key) const { return known_.count(key) == 0 ? 0 : known_.at(key).bytes.size(); }

 private:
  absl::StatusOr<UnfinishedUploads::Progress> Send(const Key& key, uint64_t offset, std::string piece) {
    return uploads_.Add(key.first, MeshOf(key.second), offset, std::move(piece), now_);
  }
  std::string ReasonAgainst(const Key& key, uint64_t offset, const std::string& piece) const;
  bool HasRoom(const Key& key, uint64_t more) const;
  bool IsIdle(const Known& known) const { return now_ - known.progress_at >= UnfinishedUploads::kShortPatience; }
  void Append(const Key& key, const std::string& bytes);
  void CheckComplete(const Key& key, const UnfinishedUploads::Progress& progress);

  latvox::MemoryBudget memory_{100 * kRoom};
  UnfinishedUploads uploads_{memory_, kRoom};
  Time now_;
  std::map<Key, Known> known_;
  std::shared_ptr<const UnfinishedUploads::Upload> held_;  // by a call that uses it
  std::string held_bytes_;
};

// Returns the reason why the bytes are wrong; empty: they are right.
std::string Uploads::ReasonAgainst(const Key& key, uint64_t offset, const std::string& piece) const {
  const MeshSpec mesh = MeshOf(key.second);
  std::string all = known_.count(key) == 0 ? "" : known_.at(key).bytes;
  if (offset > all.size()) return "WRONG_OFFSET";
  if (offset + piece.size() > mesh.bytes) return "BAD_SPEC";
  const uint64_t repeated = std::min<uint64_t>(piece.size(), all.size() - offset);
  if (all.compare(offset, repeated, piece, 0, repeated) != 0) return "BAD_SPEC";
  all += piece.substr(repeated);
  return mesh.raw && !RawMeshCheck(*mesh.raw).Add(all).ok() ? "BAD_MESH" : "";
}

// Whether so many more bytes fit once all idle uploads of others are gone.
bool Uploads::HasRoom(const Key& key, uint64_t more) const {
  uint64_t bytes = more, bytes_of_client = more;
  size_t count = 1, count_of_client = 1;
  for (const auto& [other, known] : known_) {
    if (other != key && IsIdle(known)) continue;
    const bool same_client = other.first == key.first;
    bytes += known.bytes.size();
    bytes_of_client += same_client ? known.bytes.size() : 0;
    count += other != key ? 1 : 0;
    count_of_client += other != key && same_client ? 1 : 0;
  }
  return bytes_of_client <= kRoom && bytes <= 2 * kRoom && count_of_client <= UnfinishedUploads::kMostOfClient &&
         count <= UnfinishedUploads::kMost;
}

void Uploads::Append(const Key& key, const std::string& bytes) {
  Known& known = known_.try_emplace(key, Known{"", now_}).first->second;
  const bool is_new = known.bytes.empty();
  known.bytes += bytes;
  const std::chrono::duration<double, std::milli> since = now_ - known.progress_at;
  if (is_new || static_cast<double>(known.bytes.size() - known.progress_bytes) < since.count()) return;
  known.progress_at = now_;
  known.progress_bytes = known.bytes.size();
}

void Uploads::CheckComplete(const Key& key, const UnfinishedUploads::Progress& progress) {
  const auto found = known_.find(key);
  const bool is_complete = found != known_.end() && found->second.bytes.size() == MeshOf(key.second).bytes;
  Require((progress.complete != nullptr) == is_complete);
  if (is_complete) Require(progress.complete->bytes == found->second.bytes);
}

void Uploads::Add(const Key& key, uint64_t offset, const std::string& piece) {
  const std::string reason = piece.empty() ? "" : ReasonAgainst(key, offset, piece);
  const uint64_t before = size(key), end = std::max(before, offset + piece.size());
  const bool grows = !piece.empty() && reason.empty() && end > before, has_room = !grows || HasRoom(key, end - before);
  const auto progress = Send(key, offset, piece);
  if (!reason.empty()) {
    Require(latvox::ReasonOf(progress.status()) == reason);
    if (reason != "WRONG_OFFSET") known_.erase(key);
    return;
  }
  Require(progress.ok() == has_room);
  if (!has_room) {
    Require(latvox::ReasonOf(progress.status()) == "TOO_MANY_UPLOADS" && latvox::RetryDelayOf(progress.status()));
    return;
  }
  if (grows) Append(key, piece.substr(before - offset));
  Require(progress->next_offset == (grows ? end : before));
  CheckComplete(key, *progress);
  if (progress->complete) {
    held_ = progress->complete;
    held_bytes_ = known_.at(key).bytes;
  }
}

// Idle uploads may have made room for others. All else is as in the reference.
void Uploads::Check() {
  uint64_t bytes = 0, held = held_ ? held_bytes_.size() : 0;
  std::map<std::string, uint64_t> of_clients;
  for (auto it = known_.begin(); it != known_.end();) {
    const auto progress = Send(it->first, 0, "");
    Require(progress.ok());
    if (progress->next_offset == 0 && IsIdle(it->second)) {
      it = known_.erase(it);
      continue;
    }
    Require(progress->next_offset == it->second.bytes.size());
    CheckComplete(it->first, *progress);
    if (progress->complete == held_) held = 0;
    bytes += it->second.bytes.size();
    of_clients[it->first.first] += it->second.bytes.size();
    ++it;
  }
  Require(uploads_.bytes() == bytes && uploads_.size() == known_.size() && bytes <= 2 * kRoom);
  for (const auto& [client, some] : of_clients) Require(some <= kRoom);
  Require(memory_.reserved() == bytes + held);
  if (held_) Require(held_->bytes == held_bytes_);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  FuzzedDataProvider data(bytes, size);
  Uploads uploads;
  while (data.remaining_bytes() > 0) {
    const int action = data.ConsumeIntegralInRange(0, 15);
    const Key key{std::string(1, static_cast<char>('a' + data.ConsumeIntegralInRange(0, 3))),
                  data.ConsumeIntegral<uint8_t>()};
    if (action == 0) uploads.Drop(key);
    if (action == 1) uploads.DropIdle(milliseconds(data.ConsumeIntegralInRange<int64_t>(0, kAnyTime.count())));
    if (action == 2) uploads.Wait(milliseconds(data.ConsumeIntegralInRange<int64_t>(0, kAnyTime.count())));
    if (action == 3) uploads.Wait(milliseconds(data.ConsumeIntegralInRange<int64_t>(0, kShortTime.count())));
    if (action > 3) {
      // Most pieces begin where the upload ends, or a bit before.
      const uint64_t next = uploads.size(key), back = data.ConsumeIntegral<uint8_t>();
      const uint64_t offset = back > 240 ? next + 1 : next - std::min(next, back > 128 ? 0 : back);
      const uint64_t most = data.ConsumeBool() ? kLarge : 64;
      const std::string piece =
          PieceOf(MeshOf(key.second), offset, data.ConsumeIntegralInRange<uint64_t>(0, most), data);
      for (int time = 0; time < 2; ++time) uploads.Add(key, offset, piece);
    }
    uploads.Check();
  }
  return 0;
}
