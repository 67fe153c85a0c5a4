#include "client/tool/output/npz_output.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/tool/output/dense_box.h"
#include "client/tool/output/dense_fields.h"
#include "client/tool/output/field_columns.h"
#include "client/tool/output/npy_header.h"
#include "client/tool/output/npz_member.h"
#include "client/tool/output/zip_writer.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

// Fields of links are no dense arrays: other points of the box would be most of the file.
std::vector<Field> WithoutLinks(std::vector<Field> fields) {
  std::erase_if(fields, [](Field field) { return FactsOf(field).is_of_links(); });
  return fields;
}

ZipMember Dense(const DenseArray& array, DenseBox& box) {
  std::vector<uint64_t> shape(box.shape().begin(), box.shape().end());
  if (array.components > 1) shape.push_back(array.components);
  const std::string header = NpyHeader(absl::StrCat("'", NumpyTypeOf(array.type), "'"), shape);
  const auto head = std::make_shared<std::string>(header);
  const auto rows = std::make_shared<DenseRows>(box, array.empty, array.put);
  return {array.name + ".npy", header.size() + array.bytes(box), [head, rows](std::string& chunk) {
            head->empty() ? rows->Next(chunk) : static_cast<void>(chunk = std::exchange(*head, {}));
          }};
}

class NpzOutput final : public Output {
 public:
  NpzOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields, const BoxShape& shape)
      : file_(std::move(file)), fields_(WithoutLinks(fields), DenseOrder::kLastFastest, shape) {
    for (const Field field : fields) {
      if (FactsOf(field).is_of_links()) links_.push_back({field, {}});
    }
  }

  absl::Status Begin(const Accepted& accepted) override {
    neighbors_ = accepted.neighbors;
    for (FieldValues& values : links_) values = accepted.NoValues(values.field);
    return fields_.Begin(accepted, file_->target());
  }

  absl::Status Add(const BrickBatch& batch) override {
    bricks_.insert(bricks_.end(), batch.bricks.begin(), batch.bricks.end());
    for (FieldValues& values : links_) {
      const std::vector<std::byte>& more = FindField(batch.fields, values.field)->bytes;
      values.bytes.insert(values.bytes.end(), more.begin(), more.end());
    }
    return fields_.Add(batch);
  }

  absl::Status Finish(const Summary&) override {
    if (auto status = fields_.Finish(); !status.ok()) return status;
    std::vector<ZipMember> members;
    for (const DenseArray& array : fields_.Arrays()) members.push_back(Dense(array, fields_.box()));
    members.push_back(Coordinates());
    if (!neighbors_.empty()) AddLinks(members);
    AddPlace(members);
    if (auto status = WriteZip(members, *file_); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  static std::string TriplesHeader(uint64_t count) { return NpyHeader("'<i4'", std::array<uint64_t, 2>{count, 3}); }

  uint64_t CountAll() const {
    uint64_t voxels = 0;
    for (const Brick& brick : bricks_) voxels += CountVoxels(brick);
    return voxels;
  }

  // The member reads the bricks when it is written.
  ZipMember Coordinates() const {
    const uint64_t voxels = CountAll();
    const auto head = std::make_shared<std::string>(TriplesHeader(voxels));
    return {"ijk.npy", head->size() + voxels * sizeof(Vec3i),
            [this, head, brick = size_t{0}](std::string& chunk) mutable {
              constexpr size_t kBricks = 256;
              chunk = std::exchange(*head, {});
              for (const size_t end = std::min(bricks_.size(), brick + kBricks); brick < end; ++brick) {
                ForEachVoxel(bricks_[brick], [&chunk](const Vec3i& ijk) { chunk += RawBytes(ijk); });
              }
            }};
  }

  // Adds fields of links: a row for each voxel.
  void AddLinks(std::vector<ZipMember>& members) const {
    const uint64_t rows = CountAll(), columns = neighbors_.size();
    members.push_back(RowsMember("neighbors", TriplesHeader(columns), neighbors_));
    for (const FieldValues& values : links_) {
      const std::string type = absl::StrCat("'", NumpyTypeOf(FactsOf(values.field).type), "'");
      members.push_back(
          RowsMember(NameOf(values.field), NpyHeader(type, std::array<uint64_t, 2>{rows, columns}), values.bytes));
    }
  }

  // Adds the arrays that say where the elements are.
  void AddPlace(std::vector<ZipMember>& members) {
    const auto& [basis, origin, voxel_size] = fields_.grid();
    const Vec3d low = fields_.corner();
    std::array<std::array<double, 4>, 4> affine{};
    for (size_t m = 0; m < 3; ++m) affine[m] = {basis.a[m], basis.b[m], basis.c[m], low[m]};
    affine[3][3] = 1;
    const std::array steps = {basis.a, basis.b, basis.c};
    const auto doubles = [](std::vector<uint64_t> shape) { return NpyHeader("'<f8'", shape); };
    members.push_back(
        SmallMember("index_min", NpyHeader("'<i4'", std::array<uint64_t, 1>{3}) + RawBytes(fields_.box().low())));
    members.push_back(SmallMember("affine", doubles({4, 4}) + RawBytes(affine)));
    members.push_back(SmallMember("basis", doubles({3, 3}) + RawBytes(steps)));
    members.push_back(SmallMember("origin", doubles({3}) + RawBytes(origin)));
  }

  std::unique_ptr<AtomicFile> file_;
  DenseFields fields_;
  std::vector<Vec3i> neighbors_;    // for fields of links
  std::vector<FieldValues> links_;  // the fields of links
  std::vector<Brick> bricks_;       // in the order of the stream
};

}  // namespace

std::unique_ptr<Output> NewNpzOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields,
                                     const BoxShape& shape) {
  return std::make_unique<NpzOutput>(std::move(file), fields, shape);
}

}  // namespace latvox::client
