// Keeps meshes by their digest, so that many requests on one mesh upload it once, and decode it once or twice.
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
#include "core/base/stop_signal.h"
#include "core/request/fields.h"
#include "server/decode/mesh_decoder.h"
#include "server/decode/raw_mesh.h"

namespace latvox {

// SHA-256. Without the mesh, nobody can name it, or put another one in its place.
using MeshDigest = std::array<uint8_t, 32>;

MeshDigest DigestOf(const absl::Cord& bytes);

// Does the same; returns nullopt soon after `stop` is stopped.
std::optional<MeshDigest> DigestOf(const absl::Cord& bytes, StopSignal stop);

// The digest of a larger mesh takes more than some milliseconds.
inline constexpr uint64_t kLargeMeshBytes = uint64_t{4} << 20;

// Returns the digest in a message's bytes field. INVALID_ARGUMENT unless the field has 32 bytes.
absl::StatusOr<MeshDigest> MeshDigestFrom(absl::string_view field);

// What decides, besides a mesh's bytes, on the mesh that they decode to.
struct MeshReading {
  FieldList attributes = {};
  std::optional<RawMeshLayout> layout = {};  // of plain arrays, whose bytes do not tell it

  bool operator==(const MeshReading&) const = default;
};

// Values by digest, in the order of their last use. Not thread-safe.
template <class Value>
class RecentMeshes {
 public:
  // Counts as a use. nullptr: there is no such value.
  Value* Find(const MeshDigest& digest) {
    const auto found = index_.find(digest);
    if (found == index_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    return &found->second->value;
  }

  // Precondition: there is no value with this digest.
  void Add(const MeshDigest& digest, Value value, uint64_t bytes) {
    entries_.push_front({digest, std::move(value), bytes});
    index_.emplace(digest, entries_.begin());
    bytes_ += bytes;
  }

  // Removes the least recently used value. Precondition: not empty().
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

// Thread-safe. A mesh that the store drops lives as long as someone uses it. Decoded meshes get the room that encoded
// ones leave: a decode takes milliseconds, but a lost encoded mesh costs an upload.
class MeshStore {
 public:
  //   capacity        bytes of all meshes together; 0: the store keeps none
  //   keeps_decoded   whether KeepDecoded does anything
  explicit MeshStore(uint64_t capacity, bool keeps_decoded = true)
      : capacity_(capacity), keeps_decoded_(keeps_decoded) {}

  // Counts as a use.
  std::optional<absl::Cord> Find(const MeshDigest& digest);

  // Keeps `mesh` with the digest `digest`, and drops the least recently used meshes until all fit the capacity. Does
  // nothing if this mesh alone does not fit. Returns whether the store had it before.
  bool Put(const MeshDigest& digest, const absl::Cord& mesh);

  // Does the same for a mesh that is expected to have the digest. Errors: INVALID_ARGUMENT if it has another one;
  // CANCELLED soon after `stop` is stopped.
  absl::StatusOr<bool> PutIfItHas(const MeshDigest& digest, const absl::Cord& mesh, StopSignal stop);

  // Returns the mesh that was decoded in this way, if the store keeps it; else nullptr. Counts as a use.
  std::shared_ptr<const DecodedMesh> FindDecoded(const MeshDigest& digest, const MeshReading& reading);

  // Keeps the decoded mesh with its extent, and drops the least recently used decoded ones for it. Returns the kept
  // mesh. Returns nullptr, and leaves the argument as it is, if encoded meshes leave no room, or if the store has it
  // already.
  std::shared_ptr<const DecodedMesh> KeepDecoded(const MeshDigest& digest, const MeshReading& reading,
                                                 DecodedMesh&& decoded);

  uint64_t capacity() const { return capacity_; }
  uint64_t bytes() const;

 private:
  struct Decoded {
    MeshReading reading;
    std::shared_ptr<const DecodedMesh> mesh;
  };

  // Dropped values, destroyed after the lock is released.
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
