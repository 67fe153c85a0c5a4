// Encoded meshes kept by their digest, so that many requests on one mesh upload it once.
#ifndef LATVOX_SERVER_MESH_STORE_H_
#define LATVOX_SERVER_MESH_STORE_H_

#include <array>
#include <atomic>
#include <cstdint>
#include <list>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "absl/status/statusor.h"
#include "absl/strings/cord.h"
#include "absl/strings/string_view.h"

namespace latvox {

// SHA-256: whoever does not have a mesh cannot name it, nor put another one in its place.
using MeshDigest = std::array<uint8_t, 32>;

MeshDigest DigestOf(const absl::Cord& bytes);

// The same; nullopt soon after `cancelled` is set.
std::optional<MeshDigest> DigestOf(const absl::Cord& bytes, const std::atomic<bool>& cancelled);

// More than some milliseconds' worth of digesting.
inline constexpr uint64_t kLargeMeshBytes = uint64_t{4} << 20;

// The digest of a message's bytes field. INVALID_ARGUMENT unless it has 32 bytes.
absl::StatusOr<MeshDigest> MeshDigestFrom(absl::string_view field);

// INVALID_ARGUMENT: the mesh that came has another digest than the request says.
absl::Status WrongMeshDigest();

// Thread-safe. What is dropped from the store lives on as long as someone uses it.
class MeshStore {
 public:
  explicit MeshStore(uint64_t capacity) : capacity_(capacity) {}

  // Counts as a use.
  std::optional<absl::Cord> Find(const MeshDigest& digest);

  // Keeps `mesh`, whose digest is `digest`, and drops the least recently used others until all take no more than the
  // capacity. Does nothing if it alone takes more.
  void Put(const MeshDigest& digest, const absl::Cord& mesh);

  uint64_t capacity() const { return capacity_; }
  uint64_t bytes() const;

 private:
  struct Entry {
    MeshDigest digest;
    absl::Cord mesh;
  };
  struct Hash {
    // Any bytes of a good digest are a good hash.
    size_t operator()(const MeshDigest& digest) const;
  };

  const uint64_t capacity_;
  mutable std::mutex mu_;
  // All below is guarded by mu_.
  uint64_t bytes_ = 0;
  std::list<Entry> entries_;  // the most recently used first
  std::unordered_map<MeshDigest, std::list<Entry>::iterator, Hash> index_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_MESH_STORE_H_
