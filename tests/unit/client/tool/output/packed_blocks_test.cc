// Bytes that several threads compress are those that one thread compresses, and come back whole.
#include "client/tool/output/packed_blocks.h"

#include <gmock/gmock.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <zlib.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "client/tool/output/atomic_file.h"
#include "client/tool/output/deflater.h"
#include "client/tool/output/vtk_file.h"
#include "client/tool/output/zip_writer.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

constexpr size_t kMiB = size_t{1} << 20;
constexpr int kAnyHead = 32;  // added to the window's bits: zlib or gzip

// Runs of equal bytes, runs of random ones, and empty stretches.
std::string Content(size_t bytes) {
  std::mt19937 chance(static_cast<unsigned>(bytes));
  std::string content;
  while (content.size() < bytes) {
    const size_t run = 1 + chance() % 70000;
    const bool is_random = chance() % 3 == 0;
    const char each = chance() % 2 == 0 ? '\0' : static_cast<char>(chance());
    for (size_t n = 0; n < run; ++n) content += is_random ? static_cast<char>(chance()) : each;
  }
  content.resize(bytes);
  return content;
}

// Makes the content in chunks of this size.
NextChunk Chunks(const std::string& content, size_t size) {
  return [&content, size, at = size_t{0}](std::string& chunk) mutable {
    chunk = content.substr(at, size);
    at += chunk.size();
  };
}

std::string Inflated(std::string_view bytes, int window = 15 + kAnyHead) {
  z_stream z = {};
  EXPECT_EQ(inflateInit2(&z, window), Z_OK);
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  std::string out, part(kMiB, '\0');
  int result = Z_OK;
  while (result == Z_OK) {
    z.next_out = reinterpret_cast<Bytef*>(part.data());
    z.avail_out = static_cast<uInt>(part.size());
    result = inflate(&z, Z_NO_FLUSH);
    out.append(part, 0, part.size() - z.avail_out);
  }
  EXPECT_EQ(result, Z_STREAM_END) << "the stream is broken, or its checksum is";
  EXPECT_EQ(z.avail_in, 0u) << "bytes follow the stream";
  inflateEnd(&z);
  return out;
}

class Packed : public FilesTest {
 protected:
  // Returns the bytes of the file that write(file) writes on this number of threads.
  std::string File(int threads, const std::function<absl::Status(AtomicFile&)>& write) const {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads));
    auto file = *AtomicFile::Create(Path("packed"));
    tbb::task_arena arena(threads);
    const absl::Status status = arena.execute([&] { return write(*file); });
    EXPECT_TRUE(status.ok()) << status;
    EXPECT_TRUE(file->Sync().ok());
    EXPECT_TRUE(file->Commit().ok());
    return Read("packed");
  }

  // Returns the same, and checks that the number of threads does not matter.
  std::string SameFile(const std::function<absl::Status(AtomicFile&)>& write) const {
    const std::string one = File(1, write);
    for (const int threads : {2, 5}) EXPECT_EQ(File(threads, write) == one, true) << threads << " threads";
    return one;
  }
};

TEST_F(Packed, StreamsComeBackWhole) {
  for (const size_t bytes : {size_t{0}, size_t{1}, kMiB - 1, kMiB, kMiB + 1, 7 * kMiB + 77}) {
    const std::string content = Content(bytes);
    for (const StreamForm form : {StreamForm::kZlib, StreamForm::kGzip}) {
      for (const size_t chunk : {size_t{70001}, 3 * kMiB}) {
        uint64_t told = 0;
        const std::string file = SameFile([&](AtomicFile& to) {
          const auto written = AppendDeflated(Chunks(content, chunk), form, to);
          told = written.value_or(0);
          return written.status();
        });
        EXPECT_EQ(told, file.size());
        EXPECT_EQ(Inflated(file) == content, true) << bytes;
      }
    }
  }
}

// Each block of a VTK file is what zlib makes of it in one call.
TEST_F(Packed, BlocksAreStreamsOfTheirOwn) {
  const std::string content = Content(4 * kMiB + 5);
  PackedBlocks packed(Chunks(content, 70001), PackedBlocks::Form::kZlib);
  std::vector<PackedBlock> blocks;
  size_t at = 0, count = 0;
  do {
    ASSERT_TRUE(packed.Take(blocks).ok());
    for (const PackedBlock& block : blocks) {
      std::string expected(compressBound(kMiB), '\0');
      uLongf size = expected.size();
      compress2(reinterpret_cast<Bytef*>(expected.data()), &size, reinterpret_cast<const Bytef*>(&content[at]),
                block.size, Z_BEST_SPEED);
      EXPECT_EQ(block.bytes == expected.substr(0, size), true) << "block " << count;
      EXPECT_EQ(block.size, std::min(kMiB, content.size() - at));
      at += block.size;
      ++count;
    }
  } while (!blocks.empty());
  EXPECT_EQ(count, 5u);
}

TEST_F(Packed, VtkFilesAreTheSameForAnyNumberOfThreads) {
  const std::string content = Content(6 * kMiB + 8);
  const std::string file = SameFile([&](AtomicFile& to) {
    const VtkArray array = {"a", "UInt8", 1, content.size(), Chunks(content, 70001)};
    return WriteVtkFile({"ImageData", "", "", {{"CellData", {array}}}}, to);
  });
  const size_t head = file.find("\n_") + 2;
  std::vector<uint64_t> words(3 + 7);
  file.copy(reinterpret_cast<char*>(words.data()), words.size() * sizeof(uint64_t), head);
  EXPECT_EQ(words[0], 7u);
  EXPECT_EQ(words[1], kMiB);
  EXPECT_EQ(words[2], 8u);
  std::string all;
  for (size_t n = 3, at = head + words.size() * sizeof(uint64_t); n < words.size(); at += words[n++]) {
    all += Inflated(std::string_view(file).substr(at, words[n]));
  }
  EXPECT_EQ(all == content, true);
}

TEST_F(Packed, MembersOfArchivesAreDeflateStreams) {
  const std::vector<std::string> contents = {Content(3 * kMiB + 9), Content(100)};
  const std::string file = SameFile([&](AtomicFile& to) {
    return WriteZip(
        {{"a", contents[0].size(), Chunks(contents[0], 70001)}, {"b", contents[1].size(), Chunks(contents[1], 70001)}},
        to);
  });
  constexpr size_t kHead = 30;  // bytes before the name
  size_t at = 0;
  for (const std::string& content : contents) {
    const auto number = [&](size_t from) {
      uint32_t value = 0;
      file.copy(reinterpret_cast<char*>(&value), sizeof(value), at + from);
      return value;
    };
    ASSERT_EQ(number(0), 0x04034B50u);
    EXPECT_EQ(number(8) & 0xFFFF, 8u) << "deflate";
    EXPECT_EQ(number(14), crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size())));
    EXPECT_EQ(number(22), content.size());
    const size_t data = at + kHead + (number(26) & 0xFFFF) + (number(26) >> 16);
    EXPECT_EQ(Inflated(std::string_view(file).substr(data, number(18)), -15) == content, true);
    at = data + number(18);
  }
}

TEST_F(Packed, NoMoreThanAFewBlocksAreMadeBeforeTheyAreTaken) {
  size_t made = 0;
  const auto next = [&made](std::string& chunk) {
    chunk.assign(kMiB, 'x');
    ++made;
  };
  PackedBlocks packed(next, PackedBlocks::Form::kDeflateCrc);
  std::vector<PackedBlock> blocks;
  size_t taken = 0;
  for (int n = 0; n < 5; ++n) {
    ASSERT_TRUE(packed.Take(blocks).ok());
    taken += blocks.size();
    EXPECT_LE(blocks.size(), 16u);
    EXPECT_LE(made, taken + 16);
  }
}

}  // namespace
}  // namespace latvox::client
