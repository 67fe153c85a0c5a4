#include "server/mesh_store.h"

#include <openssl/evp.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/errors.h"

namespace latvox {

MeshDigest DigestOf(const absl::Cord& bytes) {
  static const std::atomic<bool> never = false;
  return *DigestOf(bytes, never);
}

std::optional<MeshDigest> DigestOf(const absl::Cord& bytes, const std::atomic<bool>& cancelled) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  // None of these can fail but for want of memory.
  bool ok = context != nullptr && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  for (const absl::string_view chunk : bytes.Chunks()) {
    if (cancelled) return std::nullopt;
    ok = ok && EVP_DigestUpdate(context.get(), chunk.data(), chunk.size()) == 1;
  }
  MeshDigest digest;
  if (!ok || EVP_DigestFinal_ex(context.get(), digest.data(), nullptr) != 1) throw std::bad_alloc();
  return digest;
}

absl::Status WrongMeshDigest() {
  return BadSpec("mesh_sha256: the mesh that came has another digest", "mesh_sha256", "");
}

absl::StatusOr<MeshDigest> MeshDigestFrom(absl::string_view field) {
  MeshDigest digest;
  if (field.size() != digest.size()) {
    return BadSpec(absl::StrCat("mesh_sha256 has ", field.size(), " bytes, not ", digest.size()), "mesh_sha256",
                   absl::StrCat(field.size()), absl::StrCat(digest.size()));
  }
  std::copy(field.begin(), field.end(), digest.begin());
  return digest;
}

size_t MeshStore::Hash::operator()(const MeshDigest& digest) const {
  size_t hash = 0;
  std::memcpy(&hash, digest.data(), sizeof(hash));
  return hash;
}

std::optional<absl::Cord> MeshStore::Find(const MeshDigest& digest) {
  const std::lock_guard lock(mu_);
  const auto found = index_.find(digest);
  if (found == index_.end()) return std::nullopt;
  entries_.splice(entries_.begin(), entries_, found->second);
  return found->second->mesh;
}

void MeshStore::Put(const MeshDigest& digest, const absl::Cord& mesh) {
  if (mesh.size() > capacity_) return;
  std::vector<absl::Cord> dropped;  // die after the lock is released
  const std::lock_guard lock(mu_);
  if (const auto found = index_.find(digest); found != index_.end()) {
    entries_.splice(entries_.begin(), entries_, found->second);
    return;
  }
  bytes_ += mesh.size();
  entries_.push_front({digest, mesh});
  index_.emplace(digest, entries_.begin());
  while (bytes_ > capacity_) {
    Entry& last = entries_.back();
    bytes_ -= last.mesh.size();
    dropped.push_back(std::move(last.mesh));
    index_.erase(last.digest);
    entries_.pop_back();
  }
}

uint64_t MeshStore::bytes() const {
  const std::lock_guard lock(mu_);
  return bytes_;
}

}  // namespace latvox
