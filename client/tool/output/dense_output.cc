#include "client/tool/output/dense_output.h"

#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/tool/output/dense_fields.h"
#include "client/tool/output/field_columns.h"
#include "client/tool/output/npy_header.h"

namespace latvox::client {
namespace {

class DenseNpyOutput final : public Output {
 public:
  DenseNpyOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields, const BoxShape& shape)
      : file_(std::move(file)),
        has_columns_(HasColumns(fields)),
        fields_(fields, DenseOrder::kLastFastest, shape, {}, /*are_joined=*/true) {}

  absl::Status Begin(const Accepted& accepted) override { return fields_.Begin(accepted, file_->target()); }

  absl::Status Add(const BrickBatch& batch) override { return fields_.Add(batch); }

  absl::Status Finish(const Summary&) override {
    if (auto status = fields_.Finish(); !status.ok()) return status;
    DenseBox& box = fields_.box();
    const DenseArray array = Joined(fields_.Arrays());
    std::vector<uint64_t> shape(box.shape().begin(), box.shape().end());
    if (has_columns_) shape.push_back(array.components);
    const std::string header = NpyHeader(absl::StrCat("'", NumpyTypeOf(array.type), "'"), shape);
    if (auto status = file_->Append(header); !status.ok()) return status;
    DenseRows rows(box, array.empty, array.put);
    std::string chunk;
    for (rows.Next(chunk); !chunk.empty(); rows.Next(chunk)) {
      if (auto status = file_->Append(chunk); !status.ok()) return status;
    }
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  // Whether the array has an axis of components: also for a single label, so that programs work for any number of them.
  static bool HasColumns(const std::vector<Field>& fields) {
    return !fields.empty() && FactsOf(fields.front()).components != 1;
  }

  std::unique_ptr<AtomicFile> file_;
  const bool has_columns_;
  DenseFields fields_;
};

}  // namespace

std::unique_ptr<Output> NewDenseNpyOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields,
                                          const BoxShape& shape) {
  return std::make_unique<DenseNpyOutput>(std::move(file), fields, shape);
}

}  // namespace latvox::client
