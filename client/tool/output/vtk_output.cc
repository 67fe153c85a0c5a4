#include "client/tool/output/vtk_output.h"

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/tool/output/box_output.h"
#include "client/tool/output/dense_fields.h"
#include "client/tool/output/vtk_file.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

std::string Numbers(const Vec3d& v) { return absl::StrFormat("%.17g %.17g %.17g", v[0], v[1], v[2]); }

class VtiOutput final : public Output {
 public:
  VtiOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields, const BoxShape& shape)
      : file_(std::move(file)), fields_(fields, DenseOrder::kFirstFastest, shape) {}

  absl::Status Begin(const Accepted& accepted) override {
    if (!IsAlongAxes(accepted.grid.basis)) {
      return absl::InvalidArgumentError(absl::StrCat(file_->target(), ": ", kBoxesOnly));
    }
    Accepted placed = accepted;
    if (!placed.index_box) placed.index_box = IndexBox{{0, 0, 0}, {1, 1, 1}};
    return fields_.Begin(placed, file_->target());
  }

  absl::Status Add(const BrickBatch& batch) override { return fields_.Add(batch); }

  absl::Status Finish(const Summary&) override {
    if (auto status = fields_.Finish(); !status.ok()) return status;
    DenseBox& box = fields_.box();
    const Basis& basis = fields_.grid().basis;
    const Vec3d spacing = {basis.a[0], basis.b[1], basis.c[2]};
    Vec3d corner = fields_.corner();
    for (size_t m = 0; m < 3; ++m) corner[m] -= spacing[m] / 2;
    const auto [ni, nj, nk] = box.shape();
    const std::string extent = absl::StrCat("\"0 ", ni, " 0 ", nj, " 0 ", nk, "\"");
    VtkFile vtk = {
        "ImageData",
        absl::StrCat(" WholeExtent=", extent, " Origin=\"", Numbers(corner), "\" Spacing=\"", Numbers(spacing), "\""),
        absl::StrCat(" Extent=", extent),
        {{"CellData", {}}}};
    for (const DenseArray& array : fields_.Arrays()) {
      const auto rows = std::make_shared<DenseRows>(box, array.empty, array.put);
      vtk.sections[0].arrays.push_back({array.name, VtkTypeOf(array.type), array.components, array.bytes(box),
                                        [rows](std::string& chunk) { rows->Next(chunk); }});
    }
    if (auto status = WriteVtkFile(vtk, *file_); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  std::unique_ptr<AtomicFile> file_;
  DenseFields fields_;
};

class VtuOutput final : public Output {
 public:
  VtuOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields) : file_(std::move(file)) {
    for (const Field field : fields) fields_.push_back({field, {}});
  }

  absl::Status Begin(const Accepted& accepted) override {
    grid_ = accepted.grid;
    for (FieldValues& values : fields_) values.neighbors = accepted.neighbors.size();
    return absl::OkStatus();
  }

  absl::Status Add(const BrickBatch& batch) override {
    bricks_.insert(bricks_.end(), batch.bricks.begin(), batch.bricks.end());
    for (size_t n = 0; n < fields_.size(); ++n) {
      const std::vector<std::byte>& more = batch.fields[n].bytes;
      fields_[n].bytes.insert(fields_[n].bytes.end(), more.begin(), more.end());
    }
    return absl::OkStatus();
  }

  absl::Status Finish(const Summary&) override {
    voxels_ = 0;
    for (const Brick& brick : bricks_) voxels_ += CountVoxels(brick);
    std::vector<VtkArray> data = {ForEach<Vec3i>("ijk", "Int32", 3, [](const Vec3i& ijk, uint64_t) { return ijk; })};
    for (const FieldValues& values : fields_) data.push_back(Values(values));
    const auto position = [this](const Vec3i& ijk, uint64_t) { return grid_.ToWorld(ijk); };
    const auto number = [](const Vec3i&, uint64_t n) { return n; };
    const auto next = [](const Vec3i&, uint64_t n) { return n + 1; };
    const auto vertex = [](const Vec3i&, uint64_t) { return uint8_t{1}; };  // VTK_VERTEX
    const VtkFile vtk = {
        "UnstructuredGrid",
        "",
        absl::StrCat(" NumberOfPoints=\"", voxels_, "\" NumberOfCells=\"", voxels_, "\""),
        {{"PointData", data},
         {"Points", {ForEach<Vec3d>("Points", "Float64", 3, position)}},
         {"Cells",
          {ForEach<uint64_t>("connectivity", "Int64", 1, number), ForEach<uint64_t>("offsets", "Int64", 1, next),
           ForEach<uint8_t>("types", "UInt8", 1, vertex)}}}};
    if (auto status = WriteVtkFile(vtk, *file_); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  // Returns an array with value(ijk, n) for each voxel.
  template <class T>
  VtkArray ForEach(const std::string& name, const std::string& type, size_t components,
                   std::function<T(const Vec3i& ijk, uint64_t n)> value) const {
    const auto next = [this, value = std::move(value), brick = size_t{0}, n = uint64_t{0}](std::string& chunk) mutable {
      constexpr size_t kBricks = 256;
      chunk.clear();
      for (const size_t end = std::min(bricks_.size(), brick + kBricks); brick < end; ++brick) {
        ForEachVoxel(bricks_[brick], [&](const Vec3i& ijk) {
          const T one = value(ijk, n++);
          chunk.append(reinterpret_cast<const char*>(&one), sizeof(T));
        });
      }
    };
    return {name, type, components, voxels_ * sizeof(T), next};
  }

  static VtkArray Values(const FieldValues& values) {
    const auto next = [&values, done = size_t{0}](std::string& chunk) mutable {
      const size_t now = std::min(size_t{1} << 20, values.bytes.size() - done);
      chunk.assign(reinterpret_cast<const char*>(values.bytes.data()) + done, now);
      done += now;
    };
    return {NameOf(values.field), VtkTypeOf(FactsOf(values.field).type), values.components(), values.bytes.size(),
            next};
  }

  std::unique_ptr<AtomicFile> file_;
  GridTransform grid_;
  std::vector<Brick> bricks_;
  std::vector<FieldValues> fields_;
  uint64_t voxels_ = 0;
};

}  // namespace

std::unique_ptr<Output> NewVtiOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields,
                                     const BoxShape& shape) {
  return std::make_unique<VtiOutput>(std::move(file), fields, shape);
}

std::unique_ptr<Output> NewVtuOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields) {
  return std::make_unique<VtuOutput>(std::move(file), fields);
}

}  // namespace latvox::client
