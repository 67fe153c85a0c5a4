// Writers stop when their call is cancelled.
#include <gmock/gmock.h>

#include <string>
#include <vector>

#include "absl/strings/match.h"
#include "client/tool/output/output.h"
#include "client/tool/output/outputs.h"
#include "client/tool/output/vtk_file.h"
#include "client/tool/output/zip_writer.h"
#include "latvox/for_each_voxel.h"
#include "tests/unit/client/fields.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::IsEmpty;

class CancelledOutput : public FilesTest {
 protected:
  // Returns an output to which one voxel was added, with a crossing if it lists links.
  std::unique_ptr<Output> Filled(const std::string& name, const Cancellation& cancellation) const {
    const MakePage page = [](const GridContent&, const std::string&, UpAxis) { return std::string("page"); };
    VoxelizeRequest request;
    std::vector<FieldValues> values;
    Accepted accepted;
    accepted.grid = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}, 1};
    accepted.index_box = IndexBox{{0, 0, 0}, {1, 1, 1}};
    if (absl::StrContains(name, ".links.")) {
      request.fields = {Field::kLinkCrossings};
      accepted.neighbors = {{1, 0, 0}};
      values = {{Field::kLinkCrossings, std::vector<std::byte>(sizeof(uint32_t), std::byte{1}), 1}};
    }
    auto output = OpenOutput(Path(name), request, {.make_page = page, .cancellation = cancellation});
    EXPECT_TRUE(output.ok()) << output.status();
    EXPECT_TRUE((*output)->Begin(accepted).ok()) << name;
    Brick brick{{0, 0, 0}, {}};
    brick.mask[0] = 1;
    EXPECT_TRUE((*output)->Add({{&brick, 1}, 1, values}).ok()) << name;
    return *std::move(output);
  }
};

TEST_F(CancelledOutput, OfEveryFormatIsNotFinished) {
  for (const std::string& extension : OutputExtensions()) {
    const Cancellation cancellation;
    auto output = Filled("o" + extension, cancellation);
    cancellation.Cancel();
    EXPECT_EQ(output->Finish({}).code(), absl::StatusCode::kCancelled) << extension;
    output.reset();
    EXPECT_THAT(Names(), IsEmpty()) << extension;
    EXPECT_TRUE(Filled("o" + extension, {})->Finish({}).ok()) << extension;
  }
}

// Chunks that are read before others are packed: two rounds of PackedBlocks.
constexpr int kAhead = 2 * 16;

// Returns what fills a chunk, and cancels at the third one.
std::function<void(std::string&)> CancelAtThree(const Cancellation& cancellation, int& chunks) {
  return [&cancellation, &chunks](std::string& chunk) {
    chunk.assign(size_t{1} << 20, 'x');
    if (++chunks == 3) cancellation.Cancel();
  };
}

TEST_F(CancelledOutput, MakesFewFurtherChunksOfAnArchive) {
  const Cancellation cancellation;
  int chunks = 0;
  const auto file = AtomicFile::Create(Path("o.npz"), AtomicFile::Form::kUnnamed, cancellation);
  const ZipMember member = {"a.npy", uint64_t{1000} << 20, CancelAtThree(cancellation, chunks)};
  EXPECT_EQ(WriteZip({member}, **file), absl::CancelledError("cancelled"));
  EXPECT_LE(chunks, 3 + kAhead);
}

TEST_F(CancelledOutput, MakesFewFurtherChunksForVtk) {
  const Cancellation cancellation;
  int chunks = 0;
  const auto file = AtomicFile::Create(Path("o.vtu"), AtomicFile::Form::kUnnamed, cancellation);
  const VtkArray array = {"a", "UInt8", 1, uint64_t{1000} << 20, CancelAtThree(cancellation, chunks)};
  EXPECT_EQ(WriteVtkFile({"UnstructuredGrid", "", "", {{"PointData", {array}}}}, **file),
            absl::CancelledError("cancelled"));
  EXPECT_LE(chunks, 3 + kAhead);
}

// Bricks of one voxel to two of them, with their numbers as a field.
struct Numbered {
  explicit Numbered(size_t count) {
    std::vector<uint32_t> numbers;
    for (size_t n = 0; n < count; ++n) {
      Brick brick{{static_cast<int32_t>(n), 0, 0}, {}};
      brick.mask[0] = n % 2 == 0 ? 1 : 3;
      for (size_t voxel = CountVoxels(brick); voxel > 0; --voxel)
        numbers.push_back(static_cast<uint32_t>(numbers.size()));
      bricks.push_back(brick);
    }
    values = {ValuesOf(Field::kPart, numbers)};
  }
  std::vector<Brick> bricks;
  std::vector<FieldValues> values;
};

TEST(AddInPieces, PassesAllVoxelsWithTheirValues) {
  const Numbered all(1000);
  std::vector<Brick> bricks;
  std::vector<std::byte> bytes;
  int pieces = 0;
  const auto add = [&](const BrickBatch& batch) {
    ++pieces;
    size_t voxels = 0;
    for (const Brick& brick : batch.bricks) voxels += CountVoxels(brick);
    EXPECT_EQ(batch.fields.front().As<uint32_t>().size(), voxels);
    bricks.insert(bricks.end(), batch.bricks.begin(), batch.bricks.end());
    bytes.insert(bytes.end(), batch.fields.front().bytes.begin(), batch.fields.front().bytes.end());
    return absl::OkStatus();
  };
  EXPECT_TRUE(AddInPieces({all.bricks, 1, all.values}, {}, add).ok());
  EXPECT_GT(pieces, 1);
  EXPECT_EQ(bricks.size(), all.bricks.size());
  EXPECT_EQ(bytes, all.values.front().bytes);
}

TEST(AddInPieces, EndsWithTheCallAndWithTheFirstError) {
  const Numbered all(1000);
  const Cancellation cancellation;
  int pieces = 0;
  const auto cancel = [&](const BrickBatch&) { return ++pieces, cancellation.Cancel(), absl::OkStatus(); };
  EXPECT_EQ(AddInPieces({all.bricks, 1, all.values}, cancellation, cancel).code(), absl::StatusCode::kCancelled);
  const auto fail = [&](const BrickBatch&) { return ++pieces, absl::UnknownError("no"); };
  EXPECT_EQ(AddInPieces({all.bricks, 1, all.values}, {}, fail), absl::UnknownError("no"));
  EXPECT_EQ(pieces, 2);
}

}  // namespace
}  // namespace latvox::client
