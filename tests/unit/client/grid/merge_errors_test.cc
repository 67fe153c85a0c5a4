// Parts that cannot be merged, and their errors.
#include <gmock/gmock.h>

#include <cstring>
#include <filesystem>
#include <limits>

#include "client/grid/brick_tree.h"
#include "tests/unit/client/merge_parts.h"

namespace latvox::client {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class MergeErrors : public MergeTest {
 protected:
  static Bricks First() { return {MakeBrick({0, 0, 0}), MakeBrick({1, 0, 0})}; }
  static Bricks Second() { return {MakeBrick({600, 0, 0}), MakeBrick({-1, -2, -3})}; }

  template <class Matcher>
  void Refuses(const std::vector<std::string>& parts, const Matcher& says,
               absl::StatusCode code = absl::StatusCode::kInvalidArgument) {
    const auto merged = Merge(parts);
    EXPECT_EQ(merged.status().code(), code) << merged.status();
    EXPECT_THAT(std::string(merged.status().message()), says);
  }

  // The first part's file; the lengths of a leaf's values and of its mask in the tree; the places of the first ones.
  std::string Bytes() const { return Read("a.vdb"); }
  static constexpr size_t kLeaf = 140, kMask = sizeof(BrickMask);
  size_t Leaves() const { return Bytes().size() - 2 * kLeaf; }
  size_t Masks() const { return Leaves() - 2 * kMask; }
};

TEST_F(MergeErrors, PartsThatDifferInAnyFieldNameItAndBothValues) {
  const std::string a = Part("a.vdb", First());
  struct Case {
    const char *field, *mine, *theirs;
    Edit edit;
  };
  const auto text = [](const char* name, const char* value) {
    return [=](openvdb::BoolGrid& grid) { grid.insertMeta(name, openvdb::StringMetadata(value)); };
  };
  const auto number = [](const char* name, int value) {
    return [=](openvdb::BoolGrid& grid) { grid.insertMeta(name, openvdb::Int32Metadata(value)); };
  };
  const Case cases[] = {
      {"latvox_lattice", "fcc", "bcc", text("latvox_lattice", "fcc")},
      {"latvox_algorithm", "incremental", "exact", text("latvox_algorithm", "incremental")},
      {"latvox_version", "1.2.4", "1.2.3", text("latvox_version", "1.2.4")},
      {"latvox_basis", "1,2,3", "0.2", text("latvox_basis", "1,2,3")},
      {"latvox_origin", "0,0,0", "1000,-2,", text("latvox_origin", "0,0,0")},
      {"latvox_separability", "2", "1", number("latvox_separability", 2)},
      {"latvox_quantization_bits", "0", "14", number("latvox_quantization_bits", 0)},
      {"name", "other", "voxels", [](openvdb::BoolGrid& grid) { grid.setName("other"); }},
      {"latvox_of_tomorrow", "7", "absent", number("latvox_of_tomorrow", 7)},
      {"latvox_closed", "absent", "true", [](openvdb::BoolGrid& grid) { grid.removeMeta("latvox_closed"); }},
      {"latvox_shard", "0/2", "absent", Shard("0/2")},
      {"transform", ",3.0000000000000001e-05,", "1000,-2,3.0000000000000001e-05",
       [](openvdb::BoolGrid& grid) {
         grid.transform().postTranslate({0, 0, 1e-9});
       }},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.field);
    const std::string b = Part("b.vdb", Second(), c.edit);
    if (std::string(c.field) == "transform") {
      Refuses({a, b}, AllOf(HasSubstr(b + ": the transform is "), HasSubstr(", but "), HasSubstr(" in " + a)));
      continue;
    }
    const std::string mine = c.field + std::string(" is ") + c.mine, theirs = std::string(", but ") + c.theirs;
    Refuses({a, b}, AllOf(HasSubstr(b + ": " + mine), HasSubstr(theirs), HasSubstr(" in " + a)));
    EXPECT_FALSE(std::filesystem::exists(Path("merged.vdb")));
  }
}

TEST_F(MergeErrors, ShardsThatAreCutDifferently) {
  for (const char* name : {"latvox_region", "latvox_bounds"}) {
    const auto cut = [name](const std::string& shard, const std::string& box) {
      return [=](openvdb::BoolGrid& grid) {
        Shard(shard)(grid);
        if (!box.empty()) grid.insertMeta(name, openvdb::StringMetadata(box));
      };
    };
    const std::string a = Part("a.vdb", First(), cut("0/2", "1,2,3"));
    for (const char* box : {"", "1,2,4"}) {
      const std::string b = Part("b.vdb", Second(), cut("1/2", box));
      Refuses({a, b}, AllOf(HasSubstr(b + ": " + name + " is "), HasSubstr(", but 1,2,3 in " + a)));
    }
  }
}

TEST_F(MergeErrors, APartGivenTwice) {
  const std::string a = Part("a.vdb", First()), b = Part("b.vdb", Second());
  Refuses({a, b, a}, HasSubstr(a + ": is given twice"));
  std::filesystem::create_symlink(a, Path("link.vdb"));
  Refuses({a, b, Path("link.vdb")}, HasSubstr("link.vdb: is given twice"));
  std::filesystem::copy_file(a, Path("copy.vdb"));
  Refuses({a, b, Path("copy.vdb")}, AllOf(HasSubstr("copy.vdb: holds the same voxels as " + a), HasSubstr("twice")));
}

TEST_F(MergeErrors, ShardsThatAreMissingTwiceOrOfAnotherSplit) {
  const std::string a = Part("a.vdb", First(), Shard("0/12")), b = Part("b.vdb", Second(), Shard("7/12"));
  Refuses({a, b}, HasSubstr("2 of 12 shards are there; missing 1, 2, 3, 4, 5, 6, 8, 9, ..."));
  Refuses({b, a, Part("c.vdb", Second(), Shard("7/12"))},
          HasSubstr("c.vdb: latvox_shard is 7/12, and so it is in " + b));
  Refuses({a, Part("c.vdb", Second(), Shard("1/2"))}, HasSubstr("latvox_shard is 1/2, but 0/12 in " + a));
  Refuses({a, Part("c.vdb", Second())}, HasSubstr("latvox_shard is absent, but 0/12 in " + a));
  Refuses({Part("c.vdb", First(), Shard("0/2")), Part("d.vdb", {}, Shard("0/2"))}, HasSubstr("and so it is in"));
  for (const char* bad : {"2/2", "-1/2", "1", "1/", "/2", "one/two", "0/0", ""}) {
    Refuses({Part("c.vdb", First(), Shard(bad))}, HasSubstr(std::string("latvox_shard is ") + bad + ", not I/N"));
  }
}

TEST_F(MergeErrors, ShardsThatShareABrick) {
  const Brick shared = MakeBrick({4, 5, 600});
  Brick half = shared;
  half.mask[0] ^= 1;
  const std::string a = Part("a.vdb", {shared}, Shard("0/2")), b = Part("b.vdb", {half}, Shard("1/2"));
  Refuses({a, b}, AllOf(HasSubstr("holds brick 4,5,600"), HasSubstr(a), HasSubstr(b), HasSubstr("no shards")));
}

TEST_F(MergeErrors, FilesThatLatvoxDidNotWrite) {
  const std::string a = Part("a.vdb", First());
  Refuses({a, Path("none.vdb")}, HasSubstr("none.vdb: no such file"), absl::StatusCode::kNotFound);
  Refuses({a, Path("")}, HasSubstr("is a directory"));
  Refuses({a, Write("text.csv", "this is no grid, and long enough to be one")},
          AllOf(HasSubstr("text.csv: is not a whole .vdb or .nvdb file"), HasSubstr("latvox convert")));
  const auto no_digest = [](openvdb::BoolGrid& grid) { grid.removeMeta("latvox_digest"); };
  Refuses({a, Part("b.vdb", Second(), no_digest)}, HasSubstr("b.vdb: is not a whole .vdb file that latvox wrote"));
  openvdb::io::File(Path("float.vdb")).write({openvdb::FloatGrid::create(0)});
  Refuses({a, Path("float.vdb")}, HasSubstr("its first grid is a Tree_float_5_4_3"));
  openvdb::io::File(Path("two.vdb")).write({openvdb::BoolGrid::create(), openvdb::BoolGrid::create()});
  Refuses({a, Path("two.vdb")}, HasSubstr("its metadata has no latvox_digest"));
  Refuses({}, HasSubstr("no part"));
}

TEST_F(MergeErrors, TransformsThatLatvoxDoesNotWrite) {
  const std::string a = Part("a.vdb", First());
  std::string singular = Bytes();
  const std::string name = "AffineMap";
  singular.replace(singular.find(name) + name.size(), 16 * sizeof(double), 16 * sizeof(double), '\0');
  std::string infinite = Bytes();
  const double infinity = std::numeric_limits<double>::infinity();
  std::memcpy(infinite.data() + infinite.find(name) + name.size() + 12 * sizeof(double), &infinity, sizeof(infinity));
  for (const std::string& bad : {Write("bad.vdb", singular), Write("worse.vdb", infinite)}) {
    for (const auto& parts : {std::vector{bad}, std::vector{a, bad}}) {
      Refuses(parts, HasSubstr(bad + ": is not a whole .vdb file"));
    }
  }
  const auto frustum = [](openvdb::BoolGrid& grid) {
    const openvdb::BBoxd box({0, 0, 0}, {1, 1, 1});
    grid.setTransform(
        openvdb::math::Transform::createFrustumTransform(box, /*taper=*/0.5, /*depth=*/1, /*voxelDim=*/1));
  };
  Refuses({Part("b.vdb", First(), frustum)}, HasSubstr("b.vdb: is not a whole .vdb file"));
}

TEST_F(MergeErrors, AFileThatIsCutShortAnywhere) {
  const std::string b = Part("b.vdb", Second());
  Part("a.vdb", First());
  const std::string whole = Bytes();
  for (size_t length = 0; length < whole.size(); length += length < 2000 || length > Leaves() ? 1 : 501) {
    Refuses({b, Write("short.vdb", whole.substr(0, length))}, HasSubstr("short.vdb: is not a whole .vdb "));
  }
  EXPECT_TRUE(Merge({b, Write("short.vdb", whole)}).ok());
}

TEST_F(MergeErrors, ANanoFileThatIsCutShortAnywhere) {
  const std::string b = Part("b.vdb", Second());
  Part("a.nvdb", First());
  const std::string whole = Read("a.nvdb");
  for (size_t length = 0; length < whole.size(); length += length < 1000 ? 1 : 5003) {
    Refuses({b, Write("short.nvdb", whole.substr(0, length))}, HasSubstr("short.nvdb: is not a whole "));
  }
  EXPECT_TRUE(Merge({b, Write("short.nvdb", whole)}).ok());
}

// A change is an error, or leaves the voxels as they are. It may be in a node that merging does not read.
TEST_F(MergeErrors, NoChangedByteOfANanoFileChangesTheVoxels) {
  Part("a.nvdb", First());
  const std::string whole = Read("a.nvdb"), digest = MakeCertificate(First()).digest;
  const std::string mask(reinterpret_cast<const char*>(First()[0].mask.data()), sizeof(Brick::mask));
  const size_t leaves = whole.find(mask) - 16, end = leaves + 2 * 160;
  size_t refused = 0;
  for (size_t at = 0; at < whole.size(); at += at < 1000 || (at + 997 > leaves && at < end) ? 1 : 997) {
    std::string bad = whole;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    const auto merged = Merge({Write("bad.nvdb", bad)});
    EXPECT_EQ(merged.ok() ? merged->digest : digest, digest) << at;
    refused += merged.ok() ? 0 : 1;
    const bool is_voxel = at >= leaves + 16 && at < leaves + 16 + 2 * mask.size();
    EXPECT_FALSE(is_voxel && merged.ok()) << at;
  }
  EXPECT_GT(refused, 2 * 2 * mask.size());
}

TEST_F(MergeErrors, BricksThatAreNotAsTheyWereWritten) {
  Part("a.vdb", First());
  const std::string whole = Bytes();
  std::string swapped = whole;
  swapped.replace(Masks(), kMask, whole, Masks() + kMask, kMask);
  swapped.replace(Masks() + kMask, kMask, whole, Masks(), kMask);
  Refuses({Write("bad.vdb", swapped)}, HasSubstr("bad.vdb: is damaged: its voxels have digest"));
  std::string empty = whole;
  empty.replace(Masks() + kMask, kMask, kMask, '\0');
  Refuses({Write("bad.vdb", empty)}, HasSubstr("bad.vdb: is damaged: brick 2 is not as latvox wrote it"));
  // The lowest and the highest bit of each byte.
  for (size_t at = Masks(); at < Leaves(); ++at) {
    for (const int bit : {0, 7}) {
      std::string bad = whole;
      bad[at] = static_cast<char>(bad[at] ^ 1 << bit);
      Refuses({Write("bad.vdb", bad)},
              AllOf(HasSubstr("bad.vdb: is damaged: its voxels have digest"), HasSubstr("but latvox_digest is")));
    }
  }
}

// The tree has all bricks before the leaves' values begin.
TEST_F(MergeErrors, DamagedValuesDoNotChangeTheVoxels) {
  Part("a.vdb", First());
  std::string bad = Bytes();
  for (size_t at = Leaves(); at < bad.size(); ++at) bad[at] = static_cast<char>(~bad[at]);
  const auto merged = Merge({Write("bad.vdb", bad)});
  ASSERT_TRUE(merged.ok()) << merged.status();
  EXPECT_EQ(merged->digest, MakeCertificate(First()).digest);
}

TEST_F(MergeErrors, TilesThatAreNotAsTheyWereWritten) {
  Bricks bricks;
  for (int32_t n = 0; n < 300; ++n) bricks.push_back({{n / 16, n % 16, 0}, kFullBrick});
  bricks.push_back(MakeBrick({15, 15, 15}));
  Part("a.vdb", bricks);
  const std::string whole = Bytes(), digest = MakeCertificate(bricks).digest;
  const size_t node = whole.size() - kLeaf - kMask - 1200, end = whole.size() - kLeaf;  // its masks, and more
  size_t refused = 0;
  for (size_t at = node; at < end; ++at) {
    std::string bad = whole;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    const auto merged = Merge({Write("bad.vdb", bad)});
    EXPECT_EQ(merged.ok() ? merged->digest : digest, digest) << at;
    refused += merged.ok() ? 0 : 1;
  }
  EXPECT_GT(refused, 300U / 8);  // at least the bytes of the tiles' bits
}

// A change before the leaves is an error, or leaves the voxels as they are.
TEST_F(MergeErrors, NoChangedByteOfTheMetadataChangesTheVoxels) {
  Part("a.vdb", First());
  const std::string whole = Bytes(), digest = MakeCertificate(First()).digest;
  const size_t positions = whole.find("Tree_bool_5_4_3") + 15 + 4 + 8;  // of the leaves and the end, 8 bytes each
  for (size_t at = 0; at < Leaves(); at += at < 2000 ? 2 : 997) {
    const bool is_position = at >= positions && at < positions + 16;
    std::string bad = whole;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    const auto merged = Merge({Write("bad.vdb", bad)});
    EXPECT_EQ(merged.ok() ? merged->digest : digest, digest) << at;
    EXPECT_FALSE(is_position && merged.ok()) << at;
  }
}

TEST_F(MergeErrors, AResultThatCannotBeWritten) {
  const std::string a = Part("a.vdb", First());
  for (const std::string& path : {std::string("/dev/full"), Path("missing/m.vdb")}) {
    const auto merged = MergeParts({a}, path, Cancellation(), [](double, uint64_t) {});
    EXPECT_EQ(merged.status().code(), absl::StatusCode::kUnknown);
    EXPECT_THAT(std::string(merged.status().message()), HasSubstr(path + ": cannot be written"));
  }
}

}  // namespace
}  // namespace latvox::client
