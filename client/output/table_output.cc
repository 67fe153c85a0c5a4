#include "client/output/table_output.h"

#include <array>
#include <charconv>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/output/npy_header.h"
#include "client/output/voxel_walk.h"

namespace latvox::client {
namespace {

// A header, then a row for each voxel. The header holds the number of rows where the format wants it, and has the same
// length for every number, so that it can be written again when the number is known.
class TableOutput : public Output {
 public:
  TableOutput(std::unique_ptr<AtomicFile> file, bool distances) : distances_(distances), file_(std::move(file)) {}

  absl::Status Begin(const Accepted& accepted) final {
    grid_ = accepted.grid;
    return file_->Append(Header(0));
  }

  absl::Status Add(const BrickBatch& batch) final {
    const float* distance = batch.values.data();
    for (const Brick& brick : batch.bricks) {
      rows_.clear();
      ForEachVoxel(brick, [this, &distance](const Vec3i& ijk) {
        AppendRow(ijk, grid_.ToWorld(ijk), distances_ ? distance++ : nullptr, rows_);
        ++voxels_;
      });
      if (auto status = file_->Append(rows_); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::Status Finish(const Summary&) final {
    if (auto status = file_->WriteAtStart(Header(voxels_)); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() final { return file_->Commit(); }

 protected:
  const bool distances_;

 private:
  virtual std::string Header(uint64_t rows) const = 0;
  // `distance`: null unless there are distances.
  virtual void AppendRow(const Vec3i& ijk, const Vec3d& world, const float* distance, std::string& rows) const = 0;

  std::unique_ptr<AtomicFile> file_;
  GridTransform grid_;
  std::string rows_;
  uint64_t voxels_ = 0;
};

template <class T>
void AppendBinary(const T& value, std::string& rows) {
  rows.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

class CsvOutput final : public TableOutput {
 public:
  using TableOutput::TableOutput;

 private:
  std::string Header(uint64_t) const override { return distances_ ? "i,j,k,x,y,z,distance\n" : "i,j,k,x,y,z\n"; }

  void AppendRow(const Vec3i& ijk, const Vec3d& world, const float* distance, std::string& rows) const override {
    char text[192];
    char* end = text;
    for (const int32_t index : ijk) {
      end = std::to_chars(end, text + sizeof(text), index).ptr;
      *end++ = ',';
    }
    for (size_t m = 0; m < 3; ++m) {
      // As printf's %.17g in the C locale, whatever the locale.
      end = std::to_chars(end, text + sizeof(text), world[m], std::chars_format::general, 17).ptr;
      *end++ = m == 2 && distance == nullptr ? '\n' : ',';
    }
    if (distance != nullptr) {
      end = std::to_chars(end, text + sizeof(text), *distance, std::chars_format::general, 9).ptr;
      *end++ = '\n';
    }
    rows.append(text, end);
  }
};

class NpyOutput final : public TableOutput {
 public:
  using TableOutput::TableOutput;

 private:
  std::string Header(uint64_t rows) const override {
    if (distances_) return NpyHeader("[('ijk', '<i4', (3,)), ('distance', '<f4')]", std::array<uint64_t, 1>{rows});
    return NpyHeader("'<i4'", std::array<uint64_t, 2>{rows, 3});
  }

  void AppendRow(const Vec3i& ijk, const Vec3d&, const float* distance, std::string& rows) const override {
    AppendBinary(ijk, rows);
    if (distance != nullptr) AppendBinary(*distance, rows);
  }
};

class PlyOutput final : public TableOutput {
 public:
  using TableOutput::TableOutput;

 private:
  std::string Header(uint64_t rows) const override {
    const std::string count = absl::StrCat(rows);
    // The comment makes up for the number's length.
    return absl::StrCat("ply\nformat binary_little_endian 1.0\ncomment latvox voxel centres",
                        std::string(20 - count.size(), ' '), "\nelement vertex ", count,
                        "\nproperty double x\nproperty double y\nproperty double z\n"
                        "property int i\nproperty int j\nproperty int k\n",
                        distances_ ? "property float distance\n" : "", "end_header\n");
  }

  void AppendRow(const Vec3i& ijk, const Vec3d& world, const float* distance, std::string& rows) const override {
    AppendBinary(world, rows);
    AppendBinary(ijk, rows);
    if (distance != nullptr) AppendBinary(*distance, rows);
  }
};

}  // namespace

std::unique_ptr<Output> NewCsvOutput(std::unique_ptr<AtomicFile> file, bool distances) {
  return std::make_unique<CsvOutput>(std::move(file), distances);
}
std::unique_ptr<Output> NewNpyOutput(std::unique_ptr<AtomicFile> file, bool distances) {
  return std::make_unique<NpyOutput>(std::move(file), distances);
}
std::unique_ptr<Output> NewPlyOutput(std::unique_ptr<AtomicFile> file, bool distances) {
  return std::make_unique<PlyOutput>(std::move(file), distances);
}

}  // namespace latvox::client
