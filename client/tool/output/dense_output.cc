#include "client/tool/output/dense_output.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/tool/output/npy_header.h"
#include "client/tool/output/voxel_walk.h"

namespace latvox::client {
namespace {

class DenseNpyOutput final : public Output {
 public:
  explicit DenseNpyOutput(std::unique_ptr<AtomicFile> file) : file_(std::move(file)) {}

  absl::Status Begin(const Accepted& accepted) override {
    if (!accepted.index_box) return absl::OkStatus();
    low_ = accepted.index_box->min;
    constexpr uint64_t kMost = uint64_t{1} << 32;
    for (size_t m = 0; m < 3; ++m) {
      shape_[m] = static_cast<uint64_t>(int64_t{accepted.index_box->max[m]} - low_[m]);
    }
    // Multiplies step by step, so that nothing overflows.
    size_ = 1;
    for (const uint64_t side : shape_) {
      size_ *= side;
      if (size_ <= kMost) continue;
      return absl::ResourceExhaustedError(absl::StrCat(file_->target(), ": a dense array of ",
                                                       absl::StrJoin(shape_, " x "), " elements exceeds ", kMost,
                                                       " bytes; request less with --region"));
    }
    return absl::OkStatus();
  }

  absl::Status Add(const BrickBatch& batch) override {
    for (const Brick& brick : batch.bricks) {
      ForEachVoxel(brick, [this](const Vec3i& ijk) {
        uint64_t at = 0;
        for (size_t m = 0; m < 3; ++m) at = at * shape_[m] + static_cast<uint64_t>(int64_t{ijk[m]} - low_[m]);
        voxels_.push_back(static_cast<uint32_t>(at));
      });
    }
    return absl::OkStatus();
  }

  absl::Status Finish(const Summary&) override {
    if (auto status = file_->Append(NpyHeader("'|u1'", shape_)); !status.ok()) return status;
    std::sort(voxels_.begin(), voxels_.end());
    std::string chunk;
    auto next = voxels_.begin();
    for (uint64_t begin = 0; begin < size_; begin += kChunk) {
      chunk.assign(std::min(kChunk, size_ - begin), '\0');
      for (; next != voxels_.end() && *next < begin + chunk.size(); ++next) chunk[*next - begin] = 1;
      if (auto status = file_->Append(chunk); !status.ok()) return status;
    }
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  static constexpr uint64_t kChunk = uint64_t{1} << 20;

  std::unique_ptr<AtomicFile> file_;
  Vec3i low_{};
  std::array<uint64_t, 3> shape_{};
  uint64_t size_ = 0;
  std::vector<uint32_t> voxels_;  // their indices in the array
};

}  // namespace

std::unique_ptr<Output> NewDenseNpyOutput(std::unique_ptr<AtomicFile> file) {
  return std::make_unique<DenseNpyOutput>(std::move(file));
}

}  // namespace latvox::client
