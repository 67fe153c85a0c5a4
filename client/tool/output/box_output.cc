#include "client/tool/output/box_output.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

constexpr double kRounding = 1e-12;  // relative, of the vectors of a scaled lattice

// Collects all voxels, then writes the file.
class BoxOutput : public Output {
 public:
  BoxOutput(std::unique_ptr<AtomicFile> file, int32_t most, const BoxShape& shape = {})
      : file_(std::move(file)), most_(most), shape_(shape) {}

  absl::Status Begin(const Accepted& accepted) final {
    if (!IsCubic(accepted.grid.basis)) {
      return absl::InvalidArgumentError(absl::StrCat(file_->target(), ": ", kCubesOnly));
    }
    grid_ = accepted.grid;
    return absl::OkStatus();
  }

  absl::Status Add(const BrickBatch& batch) final {
    for (const Brick& brick : batch.bricks) {
      box_.Add(brick);
      ForEachVoxel(brick, [this](const Vec3i& ijk) { voxels_.push_back(ijk); });
    }
    return box_.box() ? ShapedBox(*box_.box(), shape_, file_->target()).status() : absl::OkStatus();
  }

  absl::Status Finish(const Summary&) final {
    if (auto status = MoveToCorner(); !status.ok()) return status;
    if (auto status = Write(); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() final { return file_->Commit(); }

 protected:
  AtomicFile& file() { return *file_; }
  const GridTransform& grid() const { return grid_; }
  std::vector<Vec3i>& voxels() { return voxels_; }  // relative to low()
  const Vec3i& low() const { return low_; }
  const Vec3i& sides() const { return sides_; }

 private:
  virtual absl::Status Write() = 0;

  absl::Status MoveToCorner() {
    const std::optional<IndexBox>& voxels = box_.box();
    if (!voxels && !shape_.dims) return absl::OkStatus();
    const auto shaped = ShapedBox(voxels ? *voxels : IndexBox{}, shape_, file_->target());
    if (!shaped.ok()) return shaped.status();
    const IndexBox& box = *shaped;
    low_ = box.min;
    for (size_t m = 0; m < 3; ++m) {
      const int64_t side = int64_t{box.max[m]} - low_[m];
      if (side > most_) {
        return absl::ResourceExhaustedError(absl::StrCat(file_->target(), ": ", side, " voxels along ",
                                                         std::string(1, "xyz"[m]), " exceed the format's ", most_));
      }
      sides_[m] = static_cast<int32_t>(side);
    }
    for (Vec3i& ijk : voxels_) {
      for (size_t m = 0; m < 3; ++m) ijk[m] -= low_[m];
    }
    return absl::OkStatus();
  }

  std::unique_ptr<AtomicFile> file_;
  const int32_t most_;
  const BoxShape shape_;
  GridTransform grid_;
  VoxelBox box_;
  std::vector<Vec3i> voxels_;
  Vec3i low_{}, sides_{1, 1, 1};
};

// Writes runs of (value, length) with lengths up to 255, over x, then z, then y, which changes fastest.
class BinvoxOutput final : public BoxOutput {
 public:
  BinvoxOutput(std::unique_ptr<AtomicFile> file, const BoxShape& shape) : BoxOutput(std::move(file), 4096, shape) {}

 private:
  absl::Status Write() override {
    const int64_t side = *std::max_element(sides().begin(), sides().end());
    const double size = grid().basis.a[0];
    Vec3d corner = grid().ToWorld(low());
    for (double& x : corner) x -= size / 2;
    const std::string header =
        absl::StrFormat("#binvox 1\ndim %d %d %d\ntranslate %.17g %.17g %.17g\nscale %.17g\ndata\n", side, side, side,
                        corner[0], corner[1], corner[2], size * static_cast<double>(side));
    if (auto status = file().Append(header); !status.ok()) return status;
    std::sort(voxels().begin(), voxels().end(),
              [](const Vec3i& v, const Vec3i& w) { return std::tie(v[0], v[2], v[1]) < std::tie(w[0], w[2], w[1]); });
    int64_t next = 0, begin = 0;  // the cell after the run of voxels, and its first
    for (const Vec3i& v : voxels()) {
      const int64_t cell = (v[0] * side + v[2]) * side + v[1];
      if (cell != next) {
        if (auto status = AppendRuns(next - begin, cell - next); !status.ok()) return status;
        begin = cell;
      }
      next = cell + 1;
    }
    return AppendRuns(next - begin, side * side * side - next);
  }

  // Appends a run of voxels, then a run of empty cells.
  absl::Status AppendRuns(int64_t voxels, int64_t none) {
    constexpr int64_t kMost = 255;
    for (auto [value, left] : {std::pair(char{1}, voxels), {char{0}, none}}) {
      std::string runs;
      for (; left > 0; left -= kMost) {
        runs.push_back(value);
        runs.push_back(static_cast<char>(std::min(left, kMost)));
        if (runs.size() < kFlush) continue;
        if (auto status = file().Append(runs); !status.ok()) return status;
        runs.clear();
      }
      if (auto status = file().Append(runs); !status.ok()) return status;
    }
    return absl::OkStatus();
  }
  static constexpr size_t kFlush = size_t{1} << 16;
};

// Writes "VOX ", version 150, and a chunk MAIN of the chunks SIZE and XYZI. A chunk has an id, its bytes, the bytes of
// its subchunks, and contents.
class VoxOutput final : public BoxOutput {
 public:
  explicit VoxOutput(std::unique_ptr<AtomicFile> file) : BoxOutput(std::move(file), 256) {}

 private:
  static constexpr uint8_t kColor = 1;  // in the default palette of the program

  static std::string Words(std::initializer_list<size_t> words) {
    std::string bytes;
    for (const size_t word : words) {
      for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(word >> shift & 0xFF));
    }
    return bytes;
  }

  absl::Status Write() override {
    const auto side = [&](size_t m) { return static_cast<size_t>(sides()[m]); };
    // 256^3 voxels of four bytes are the maximum: all lengths fit.
    const std::string size = "SIZE" + Words({12, 0, side(0), side(1), side(2)});
    const std::string head = "XYZI" + Words({4 + 4 * voxels().size(), 0, voxels().size()});
    const size_t children = size.size() + head.size() + 4 * voxels().size();
    std::string rows = "VOX " + Words({150}) + "MAIN" + Words({0, children}) + size + head;
    for (const Vec3i& v : voxels()) {
      for (const int32_t x : v) rows.push_back(static_cast<char>(x));
      rows.push_back(static_cast<char>(kColor));
    }
    return file().Append(rows);
  }
};

}  // namespace

bool IsAlongAxes(const Basis& basis) {
  const Vec3d steps[] = {basis.a, basis.b, basis.c};
  for (size_t n = 0; n < 3; ++n) {
    for (size_t m = 0; m < 3; ++m) {
      if (n == m ? !(steps[n][n] > 0) : !(std::abs(steps[n][m]) <= kRounding * steps[n][n])) return false;
    }
  }
  return true;
}

bool IsCubic(const Basis& basis) {
  const double side = basis.a[0];
  const auto is_side = [side](double other) { return std::abs(other - side) <= kRounding * side; };
  return IsAlongAxes(basis) && is_side(basis.b[1]) && is_side(basis.c[2]);
}

std::unique_ptr<Output> NewBinvoxOutput(std::unique_ptr<AtomicFile> file, const BoxShape& shape) {
  return std::make_unique<BinvoxOutput>(std::move(file), shape);
}

std::unique_ptr<Output> NewVoxOutput(std::unique_ptr<AtomicFile> file) {
  return std::make_unique<VoxOutput>(std::move(file));
}

}  // namespace latvox::client
