#include "client/tool/output/packed_blocks.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>
#include <oneapi/tbb/task_arena.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <string_view>
#include <utility>

#include "absl/cleanup/cleanup.h"
#include "deploy/process/exhaustion.h"

namespace latvox::client {
namespace {

uint32_t CheckOf(PackedBlocks::Form form, const Bytef* bytes, uInt count) {
  switch (form) {
    case PackedBlocks::Form::kDeflateCrc:
      return static_cast<uint32_t>(crc32(crc32(0, nullptr, 0), bytes, count));
    case PackedBlocks::Form::kDeflateAdler:
      return static_cast<uint32_t>(adler32(adler32(0, nullptr, 0), bytes, count));
    case PackedBlocks::Form::kZlib:
      break;
  }
  return 0;
}

// Returns false without memory. Throws std::bad_alloc. A full flush ends a piece on a whole byte, and the next one
// refers to nothing before.
bool Pack(std::string_view bytes, PackedBlocks::Form form, PackedBlock& block) {
  constexpr int kWindowBits = 15, kMemoryLevel = 8;
  constexpr uLong kFlush = 16;  // more than the bytes of a flush
  const bool is_whole = form == PackedBlocks::Form::kZlib;
  z_stream z = {};
  if (deflateInit2(&z, Z_BEST_SPEED, Z_DEFLATED, is_whole ? kWindowBits : -kWindowBits, kMemoryLevel,
                   Z_DEFAULT_STRATEGY) != Z_OK) {
    return false;
  }
  const absl::Cleanup end = [&z] { deflateEnd(&z); };
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib does not write there
  z.avail_in = static_cast<uInt>(bytes.size());
  block.check = CheckOf(form, z.next_in, z.avail_in);
  block.size = bytes.size();
  block.bytes.resize(deflateBound(&z, bytes.size()) + kFlush);
  z.next_out = reinterpret_cast<Bytef*>(block.bytes.data());
  z.avail_out = static_cast<uInt>(block.bytes.size());
  const int result = deflate(&z, is_whole ? Z_FINISH : Z_FULL_FLUSH);
  block.bytes.resize(block.bytes.size() - z.avail_out);
  return is_whole ? result == Z_STREAM_END : result == Z_OK && z.avail_in == 0;
}

}  // namespace

PackedBlocks::PackedBlocks(NextChunk next, Form form)
    : next_(std::move(next)),
      form_(form),
      most_(static_cast<size_t>(std::clamp(tbb::this_task_arena::max_concurrency(), 1, 16))) {}

void PackedBlocks::Read() {
  later_.resize(most_);
  count_ = 0;
  for (std::string& block : later_) {
    block.clear();
    while (block.size() < kBlock && !ended_) {
      if (at_ == chunk_.size()) {
        next_(chunk_);
        at_ = 0;
        ended_ = chunk_.empty();
      }
      const size_t more = std::min(kBlock - block.size(), chunk_.size() - at_);
      block.append(chunk_, at_, more);
      at_ += more;
    }
    if (block.empty()) return;
    ++count_;
  }
}

absl::Status PackedBlocks::Take(std::vector<PackedBlock>& blocks) {
  if (!std::exchange(begun_, true)) Read();
  now_.swap(later_);
  blocks.resize(count_);
  if (blocks.empty()) return absl::OkStatus();
  std::atomic<bool> good = true;
  const auto pack = [&](size_t n) {
    if (!Pack(now_[n], form_, blocks[n])) good = false;
  };
  tbb::task_arena arena(HasAddressesForThreads() ? tbb::task_arena::automatic : 1);
  arena.execute(
      [&] { tbb::parallel_invoke([this] { Read(); }, [&] { tbb::parallel_for(size_t{0}, blocks.size(), pack); }); });
  return good ? absl::OkStatus() : absl::ResourceExhaustedError("no memory to compress it");
}

}  // namespace latvox::client
