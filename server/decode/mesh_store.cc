#include "server/decode/mesh_store.h"

#include <openssl/evp.h>

#include <algorithm>
#include <memory>
#include <new>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/base/errors.h"

namespace latvox {

MeshDigest DigestOf(const absl::Cord& bytes) { return *DigestOf(bytes, StopSignal()); }

std::optional<MeshDigest> DigestOf(const absl::Cord& bytes, StopSignal stop) {
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(), &EVP_MD_CTX_free);
  // These calls can fail only without memory.
  bool ok = context != nullptr && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  for (const absl::string_view chunk : bytes.Chunks()) {
    if (stop.Stopped()) return std::nullopt;
    ok = ok && EVP_DigestUpdate(context.get(), chunk.data(), chunk.size()) == 1;
  }
  MeshDigest digest;
  if (!ok || EVP_DigestFinal_ex(context.get(), digest.data(), nullptr) != 1) throw std::bad_alloc();
  return digest;
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

std::optional<absl::Cord> MeshStore::Find(const MeshDigest& digest) {
  const std::lock_guard lock(mu_);
  const absl::Cord* const mesh = encoded_.Find(digest);
  return mesh ? std::optional(*mesh) : std::nullopt;
}

bool MeshStore::Put(const MeshDigest& digest, const absl::Cord& mesh) {
  if (mesh.size() > capacity_) return false;
  Dropped dropped;
  const std::lock_guard lock(mu_);
  if (encoded_.Find(digest)) return true;
  encoded_.Add(digest, mesh, mesh.size());
  DropWhatExceeds(dropped);
  return false;
}

absl::StatusOr<bool> MeshStore::PutIfItHas(const MeshDigest& digest, const absl::Cord& mesh, StopSignal stop) {
  const std::optional<MeshDigest> found = DigestOf(mesh, stop);
  if (!found) return absl::CancelledError("the request was cancelled");
  if (*found != digest) return BadSpec("mesh_sha256: the mesh that came has another digest", "mesh_sha256", "");
  return Put(digest, mesh);
}

std::shared_ptr<const DecodedMesh> MeshStore::FindDecoded(const MeshDigest& digest, const MeshReading& reading) {
  const std::lock_guard lock(mu_);
  const Decoded* const decoded = decoded_.Find(digest);
  return decoded && decoded->reading == reading ? decoded->mesh : nullptr;
}

std::shared_ptr<const DecodedMesh> MeshStore::KeepDecoded(const MeshDigest& digest, const MeshReading& reading,
                                                          DecodedMesh&& decoded) {
  const TriangleMesh& mesh = decoded.mesh;
  const uint64_t bytes = sizeof(DecodedMesh) + mesh.triangles.size() * sizeof(mesh.triangles[0]) +
                         VisitVertices(mesh, [](const auto& v) { return v.get_allocator().BytesOf(v.size()); }) +
                         mesh.attributes.size() * sizeof(mesh.attributes[0]);
  Dropped dropped;
  const std::lock_guard lock(mu_);
  const bool fits = keeps_decoded_ && bytes <= capacity_ && encoded_.bytes() <= capacity_ - bytes;
  if (!fits || decoded_.Find(digest)) return nullptr;
  auto kept = std::make_shared<const DecodedMesh>(std::move(decoded));
  decoded_.Add(digest, {reading, kept}, bytes);
  DropWhatExceeds(dropped);
  return kept;
}

void MeshStore::DropWhatExceeds(Dropped& dropped) {
  while (encoded_.bytes() + decoded_.bytes() > capacity_) {
    if (decoded_.empty()) {
      dropped.encoded.push_back(encoded_.DropLast());
    } else {
      dropped.decoded.push_back(decoded_.DropLast());
    }
  }
}

uint64_t MeshStore::bytes() const {
  const std::lock_guard lock(mu_);
  return encoded_.bytes() + decoded_.bytes();
}

}  // namespace latvox
