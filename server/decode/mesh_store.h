// Meshes kept by their digest, so that many requests on one mesh upload it once, and decode it once or twice.
#ifndef LATVOX_SERVER_DECODE_MESH_STORE_H_
#define LATVOX_SERVER_DECODE_MESH_STORE_H_

#include <array>
#include <cstdint>
#include <cstring>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/cord.h"
#include "absl/strings/string_view.h"
#include "core/request/fields.h"
#include "server/decode/mesh_decoder.h"

namespace latvox {

// SHA-256: whoever does not have a mesh cannot name it, nor put another one in its place.
using MeshDigest = std::array<uint8_t, 32>;

MeshDigest DigestOf(const absl::Cord& bytes);

// The same; nullopt soon after `stop` is stopped.
std::optional<MeshDigest> DigestOf(const absl::Cord& bytes, StopSignal stop);

// More than some milliseconds' worth of digesting.
inline constexpr uint64_t kLargeMeshBytes = uint64_t{4} << 20;

// The digest of a message's bytes field. INVALID_ARGUMENT unless it has 32 bytes.
absl::StatusOr<MeshDigest> MeshDigestFrom(absl::string_view field);

// INVALID_ARGUMENT: the mesh that came has another digest than the request says.
absl::Status WrongMeshDigest();

// Values by digest, the most recently used first. Not thread-safe.
template <class Value>
class RecentMeshes {
 public:
  // Counts as a use. nullptr: there is none.
  Value* Find(const MeshDigest& digest) {
    const auto found = index_.find(digest);
    if (found == index_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    return &found->second->value;
  }

  // Precondition: there is none of this digest.
  void Add(const MeshDigest& digest, Value value, uint64_t bytes) {
    entries_.push_front({digest, std::move(value), bytes});
    index_.emplace(digest, entries_.begin());
    bytes_ += bytes;
  }

  // Takes out the least recently used. Precondition: not empty().
  Value DropLast() {
    Entry last = std::move(entries_.back());
    entries_.pop_back();
    index_.erase(last.digest);
    bytes_ -= last.bytes;
    return std::move(last.value);
  }

  bool empty() const { return entries_.empty(); }
  uint64_t bytes() const { return bytes_; }

 private:
  struct Entry {
    MeshDigest digest;
    Value value;
    uint64_t bytes;
  };
  struct Hash {
    // Any bytes of a good digest are a good hash.
    size_t operator()(const MeshDigest& digest) const {
      size_t hash = 0;
      std::memcpy(&hash, digest.data(), sizeof(hash));
      return hash;
    }
  };

  uint64_t bytes_ = 0;
  std::list<Entry> entries_;
  std::unordered_map<MeshDigest, typename std::list<Entry>::iterator, Hash> index_;
};

// Thread-safe. What is dropped from the store lives on as long as someone uses it. Decoded meshes take the room that
// encoded ones leave: they are a matter of milliseconds, the others of an upload.
class MeshStore {
 public:
  //   capacity        bytes of all meshes together; 0: none is kept
  //   keeps_decoded   whether KeepDecoded does anything
  explicit MeshStore(uint64_t capacity, bool keeps_decoded = true)
      : capacity_(capacity), keeps_decoded_(keeps_decoded) {}

  // Counts as a use.
  std::optional<absl::Cord> Find(const MeshDigest& digest);

  // Keeps `mesh`, whose digest is `digest`, and drops the least recently used others until all take no more than the
  // capacity. Does nothing if it alone takes more. Returns whether it was there before.
  bool Put(const MeshDigest& digest, const absl::Cord& mesh);

  // What the mesh was decoded to, with these attributes, if that is kept; else nullptr. Counts as a use.
  std::shared_ptr<const DecodedMesh> FindDecoded(const MeshDigest& digest, const FieldList& attributes);

  // Takes what the mesh was decoded to, with its extent, keeps it, and drops the least recently used others of its kind
  // for it. Returns what it keeps; or nullptr, and takes nothing, if encoded meshes leave no room, or there is one of
  // this mesh already.
  std::shared_ptr<const DecodedMesh> KeepDecoded(const MeshDigest& digest, const FieldList& attributes,
                                                 DecodedMesh&& decoded);

  uint64_t capacity() const { return capacity_; }
  uint64_t bytes() const;

 private:
  struct Decoded {
    FieldList attributes;
    std::shared_ptr<const DecodedMesh> mesh;
  };

  // What was dropped: to die after the lock is released.
  struct Dropped {
    std::vector<absl::Cord> encoded;
    std::vector<Decoded> decoded;
  };

  void DropWhatExceeds(Dropped& dropped);

  const uint64_t capacity_;
  const bool keeps_decoded_;
  mutable std::mutex mu_;
  // All below is guarded by mu_.
  RecentMeshes<absl::Cord> encoded_;
  RecentMeshes<Decoded> decoded_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_MESH_STORE_H_
