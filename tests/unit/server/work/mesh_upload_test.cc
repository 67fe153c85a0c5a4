// Uploads: their pieces, length and time.
#include "server/work/mesh_upload.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <utility>

#include "absl/time/clock.h"

namespace latvox {
namespace {

TEST(MeshUpload, HandsOverPiecesOfAnySizeInOrder) {
  std::string all;
  for (const size_t piece : {1u, 70000u, 5u, 65536u, 0u, 3u, 200000u}) {
    MeshUpload upload(0, 1 << 30);
    all.clear();
    for (int n = 0; n < 20; ++n) {
      std::string bytes(n % 3 == 0 ? piece : 10, static_cast<char>('a' + n));
      all += bytes;
      ASSERT_TRUE(upload.Append(std::move(bytes)).ok());
    }
    EXPECT_EQ(upload.size(), all.size());
    EXPECT_EQ(std::string(std::move(upload).Release()), all);
  }
}

TEST(MeshUpload, HoldsTheLengthAgainstLimitAndDeclaration) {
  MeshUpload limited(0, 10);
  EXPECT_TRUE(limited.Append("0123456789").ok());
  EXPECT_TRUE(limited.CheckComplete().ok());
  const absl::Status over = limited.Append("x");
  EXPECT_EQ(over.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(over.message(), "mesh_bytes 11 exceeds 10");

  MeshUpload declared(5, 10);
  EXPECT_TRUE(declared.Append("0123").ok());
  EXPECT_EQ(declared.CheckComplete().message(), "mesh_bytes 5 was declared, but only 4 bytes came");
  EXPECT_TRUE(declared.Append("4").ok());
  EXPECT_TRUE(declared.CheckComplete().ok());
  EXPECT_EQ(declared.Append("5").message(), "mesh_bytes 5 was declared, but at least 6 bytes came");
  EXPECT_EQ(MeshUpload(0, 10).CheckComplete().message(), "mesh: no bytes came");
}

TEST(MeshUpload, TakesTheTimeFromTheSpecificationToTheLastByte) {
  MeshUpload upload(0, 10);
  EXPECT_EQ(upload.milliseconds(), std::nullopt);
  absl::SleepFor(absl::Milliseconds(5));
  EXPECT_TRUE(upload.Append("x").ok());
  const double one_piece = upload.milliseconds().value();
  EXPECT_GE(one_piece, 5);
  absl::SleepFor(absl::Milliseconds(5));
  EXPECT_EQ(upload.milliseconds(), one_piece);
  EXPECT_TRUE(upload.Append("y").ok());
  EXPECT_GE(upload.milliseconds().value(), one_piece + 5);
}

}  // namespace
}  // namespace latvox
