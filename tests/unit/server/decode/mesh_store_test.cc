// Stored meshes, encoded and decoded.
#include "server/decode/mesh_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "absl/strings/escaping.h"

namespace latvox {
namespace {

// FIPS 180-2, appendix B.1.
TEST(MeshDigest, IsSha256OfAllPieces) {
  absl::Cord cord("a");
  cord.Append(absl::MakeCordFromExternal("bc", [](absl::string_view) {}));
  const MeshDigest digest = DigestOf(cord);
  EXPECT_EQ(absl::BytesToHexString({reinterpret_cast<const char*>(digest.data()), digest.size()}),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

MeshDigest Digest(int n) { return DigestOf(absl::Cord(std::string(1, static_cast<char>(n)))); }
absl::Cord Bytes(size_t size) { return absl::Cord(std::string(size, 'x')); }

TEST(MeshStore, DropsTheLeastRecentlyUsedFirst) {
  MeshStore store(100);
  store.Put(Digest(1), Bytes(40));
  store.Put(Digest(2), Bytes(40));
  EXPECT_TRUE(store.Find(Digest(1)));  // a use
  store.Put(Digest(3), Bytes(40));
  EXPECT_TRUE(store.Find(Digest(1)));
  EXPECT_FALSE(store.Find(Digest(2)));
  EXPECT_TRUE(store.Find(Digest(3)));
  EXPECT_EQ(store.bytes(), 80);
  store.Put(Digest(1), Bytes(40));  // again: a use, and no more bytes
  EXPECT_EQ(store.bytes(), 80);
  store.Put(Digest(4), Bytes(60));
  EXPECT_FALSE(store.Find(Digest(3)));
  EXPECT_EQ(store.Find(Digest(4))->size(), 60);
  EXPECT_EQ(store.bytes(), 100);
}

DecodedMesh Decoded(size_t triangles) {
  DecodedMesh decoded;
  decoded.mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  decoded.mesh.triangles.assign(triangles, {0, 1, 2});
  return decoded;
}

TEST(MeshStore, KeepsDecodedMeshesInTheRoomThatEncodedOnesLeave) {
  const MeshReading none, part{.attributes = {Field::kPart}};
  MeshStore store(3000);
  store.Put(Digest(1), Bytes(40));
  ASSERT_TRUE(store.KeepDecoded(Digest(1), none, Decoded(100)));
  const auto kept = store.FindDecoded(Digest(1), none);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->mesh.triangles.size(), 100);
  EXPECT_FALSE(store.FindDecoded(Digest(1), part));
  EXPECT_FALSE(store.FindDecoded(Digest(2), none));
  const uint64_t bytes = store.bytes() - 40;
  EXPECT_GE(bytes, 1200 + 36);

  store.KeepDecoded(Digest(2), none, Decoded(100));
  EXPECT_TRUE(store.FindDecoded(Digest(1), none));  // a use
  store.KeepDecoded(Digest(3), none, Decoded(100));
  EXPECT_TRUE(store.FindDecoded(Digest(1), none));
  EXPECT_FALSE(store.FindDecoded(Digest(2), none));
  EXPECT_TRUE(store.FindDecoded(Digest(3), none));
  EXPECT_EQ(store.bytes(), 40 + 2 * bytes);

  DecodedMesh again = Decoded(100);
  EXPECT_FALSE(store.KeepDecoded(Digest(1), part, std::move(again)));
  EXPECT_EQ(again.mesh.triangles.size(), 100);  // not taken

  // Encoded meshes go before decoded ones, and are not dropped for one.
  store.Put(Digest(4), Bytes(2900));
  EXPECT_EQ(store.bytes(), 2940);
  EXPECT_FALSE(store.KeepDecoded(Digest(1), none, std::move(again)));
  EXPECT_EQ(again.mesh.triangles.size(), 100);
  EXPECT_EQ(store.bytes(), 2940);
  EXPECT_EQ(kept->mesh.triangles.size(), 100);
}

TEST(MeshStore, FindsADecodedMeshOnlyForTheLayoutOfItsBytes) {
  const RawMeshLayout layout{.vertices = 3, .triangles = 100}, other{.vertices = 103, .triangles = 0};
  ASSERT_EQ(layout.bytes(), other.bytes());
  MeshStore store(3000);
  ASSERT_TRUE(store.KeepDecoded(Digest(1), {.layout = layout}, Decoded(100)));
  EXPECT_TRUE(store.FindDecoded(Digest(1), {.layout = layout}));
  EXPECT_FALSE(store.FindDecoded(Digest(1), {.layout = other}));
  EXPECT_FALSE(store.FindDecoded(Digest(1), {}));
}

TEST(MeshStore, KeepsNoDecodedMeshIfToldSo) {
  MeshStore store(3000, false);
  store.KeepDecoded(Digest(1), {}, Decoded(100));
  EXPECT_FALSE(store.FindDecoded(Digest(1), {}));
  EXPECT_EQ(store.bytes(), 0);
}

TEST(MeshStore, LeavesAMeshOutThatAloneExceedsIt) {
  MeshStore store(100);
  store.Put(Digest(1), Bytes(40));
  store.Put(Digest(2), Bytes(101));
  EXPECT_FALSE(store.Find(Digest(2)));
  EXPECT_TRUE(store.Find(Digest(1)));
}

}  // namespace
}  // namespace latvox
