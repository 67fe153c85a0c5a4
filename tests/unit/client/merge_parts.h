// Parts of voxelizations for the tests of merging.
#ifndef LATVOX_TESTS_UNIT_CLIENT_MERGE_PARTS_H_
#define LATVOX_TESTS_UNIT_CLIENT_MERGE_PARTS_H_

#include <functional>
#include <string>
#include <vector>

#include "client/grid/openvdb_trees.h"
#include "client/internal/digest.h"
#include "latvox/grid/merge.h"
#include "latvox/grid/openvdb_grid.h"
#include "latvox/grid/voxel_grid.h"
#include "tests/unit/client/files.h"

namespace latvox::client {

class MergeTest : public FilesTest {
 protected:
  using Bricks = std::vector<Brick>;
  using Edit = std::function<void(openvdb::BoolGrid&)>;

  // Not orthogonal, and far from the world's origin.
  static GridTransform MakeTransform() {
    return {{{0.2, 0, 0}, {0, 0.2, 0}, {0.1, 0.1, 0.1}}, {1000, -2, 3e-5}, 0.15874010519681994};
  }

  // Every brick has other voxels.
  static Brick MakeBrick(const Vec3i& brick_ijk) {
    Brick brick{brick_ijk, {}};
    const auto [i, j, k] = brick_ijk;
    uint64_t word = 0x9E3779B97F4A7C15;
    for (const int32_t n : {i, j, k}) word = (word ^ static_cast<uint32_t>(n)) * 0xD6E8FEB86659FD93;
    for (size_t x = word % 3; x < 8; x += 1 + word % 5) brick.mask[x] = word = word << 9 ^ word >> 7;
    return brick;
  }

  static Certificate MakeCertificate(const Bricks& bricks) {
    Digest digest;
    for (const Brick& brick : bricks) digest.Add(brick);
    Certificate certificate;
    certificate.lattice = "bcc";
    certificate.separability = 1;
    certificate.tunnel_free = certificate.minimal = certificate.closed = true;
    certificate.snap_error_max = 0.001953125;
    certificate.quantization_bits = 14;
    certificate.algorithm = "exact";
    certificate.version = "1.2.3";
    certificate.digest = digest.ToHex();
    return certificate;
  }

  // Writes a .vdb or .nvdb file like that of `latvox voxelize`, after `edit`. Returns its path.
  std::string Part(
      const std::string& name, const Bricks& bricks, const Edit& edit = [](openvdb::BoolGrid&) {}) const {
    VoxelGrid grid(MakeTransform());
    EXPECT_TRUE(grid.Add({bricks, 1}).ok());
    grid.SetCertificate(MakeCertificate(bricks));
    edit(*grid.content().grid);
    const bool is_nano = name.ends_with(".nvdb");
    EXPECT_TRUE((is_nano ? grid.WriteNano(Path(name)) : grid.Write(Path(name))).ok());
    return Path(name);
  }

  static Edit Shard(const std::string& text) {
    return [text](openvdb::BoolGrid& grid) { grid.insertMeta("latvox_shard", openvdb::StringMetadata(text)); };
  }

  absl::StatusOr<MergedGrid> Merge(const std::vector<std::string>& parts) const {
    return MergeParts(parts, Path("merged.vdb"), Cancellation(), [](double, uint64_t) {});
  }

  // Returns a file's bytes without its random identity, which follows magic number, versions and flag.
  std::string Content(const std::string& name) const { return Read(name).replace(21, 36, ""); }
};

}  // namespace latvox::client

#endif  // LATVOX_TESTS_UNIT_CLIENT_MERGE_PARTS_H_
