#include "client/tool/output/dense_output.h"

#include <string>
#include <utility>

#include "client/tool/output/dense_box.h"
#include "client/tool/output/npy_header.h"

namespace latvox::client {
namespace {

class DenseNpyOutput final : public Output {
 public:
  explicit DenseNpyOutput(std::unique_ptr<AtomicFile> file) : file_(std::move(file)) {}

  absl::Status Begin(const Accepted& accepted) override {
    return box_.SetBox(accepted.index_box, /*element_bytes=*/1, file_->target());
  }

  absl::Status Add(const BrickBatch& batch) override {
    box_.Add(batch);
    return absl::OkStatus();
  }

  absl::Status Finish(const Summary&) override {
    if (auto status = file_->Append(NpyHeader("'|u1'", box_.shape())); !status.ok()) return status;
    box_.Sort();
    DenseRows rows(box_, std::string(1, '\0'), [](uint64_t, char* element) { *element = 1; });
    std::string chunk;
    for (rows.Next(chunk); !chunk.empty(); rows.Next(chunk)) {
      if (auto status = file_->Append(chunk); !status.ok()) return status;
    }
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  std::unique_ptr<AtomicFile> file_;
  DenseBox box_;
};

}  // namespace

std::unique_ptr<Output> NewDenseNpyOutput(std::unique_ptr<AtomicFile> file) {
  return std::make_unique<DenseNpyOutput>(std::move(file));
}

}  // namespace latvox::client
