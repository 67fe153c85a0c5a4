#include "client/tool/output/npz_output.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/tool/output/dense_box.h"
#include "client/tool/output/field_columns.h"
#include "client/tool/output/npy_header.h"
#include "client/tool/output/zip_writer.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

template <class T>
std::string BytesOf(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof(value)};
}

// Returns a member whose bytes are at hand.
ZipMember Small(const std::string& name, std::string bytes) {
  const uint64_t size = bytes.size();
  const auto rest = std::make_shared<std::string>(std::move(bytes));
  return {name + ".npy", size, [rest](std::string& chunk) { chunk = std::exchange(*rest, {}); }};
}

// Returns a member that copies an array piece by piece. `array` must live until it is written.
template <class T>
ZipMember Rows(const std::string& name, std::string header, const std::vector<T>& array) {
  static constexpr size_t kPiece = size_t{1} << 20;
  const uint64_t size = header.size() + array.size() * sizeof(T);
  const auto rest = std::make_shared<std::string>(std::move(header));
  return {name + ".npy", size, [rest, &array, done = size_t{0}](std::string& chunk) mutable {
            if (!rest->empty()) {
              chunk = std::exchange(*rest, {});
              return;
            }
            const size_t now = std::min(kPiece, array.size() * sizeof(T) - done);
            chunk.assign(reinterpret_cast<const char*>(array.data()) + done, now);
            done += now;
          }};
}

// One array over all lattice points of a box.
struct DenseArray {
  std::string name, type;  // type: as in NpyHeader
  size_t components;       // of an element
  std::string empty;       // bytes of an element that is not a voxel
  std::function<void(uint64_t n, char* element)> put;
};

ZipMember Dense(const DenseArray& field, DenseBox& box) {
  std::vector<uint64_t> shape(box.shape().begin(), box.shape().end());
  if (field.components > 1) shape.push_back(field.components);
  const std::string header = NpyHeader(field.type, shape);
  const uint64_t bytes = header.size() + box.shape()[0] * box.shape()[1] * box.shape()[2] * field.empty.size();
  const auto head = std::make_shared<std::string>(header);
  const auto rows = std::make_shared<DenseRows>(box, field.empty, field.put);
  return {field.name + ".npy", bytes, [head, rows](std::string& chunk) {
            head->empty() ? rows->Next(chunk) : static_cast<void>(chunk = std::exchange(*head, {}));
          }};
}

// Returns the bytes of a component where there is no voxel: NaN, -1, or 0 for colors and fractions.
std::string EmptyOf(NumberType type) {
  if (type == NumberType::kFloat32) return BytesOf(std::numeric_limits<float>::quiet_NaN());
  if (type == NumberType::kUint32) return BytesOf(int32_t{-1});
  return type == NumberType::kUint16 ? BytesOf(uint16_t{0}) : BytesOf(uint8_t{0});
}

class NpzOutput final : public Output {
 public:
  NpzOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields) : file_(std::move(file)) {
    for (const Field field : fields) fields_.push_back({field, {}});
  }

  absl::Status Begin(const Accepted& accepted) override {
    grid_ = accepted.grid;
    neighbors_ = accepted.neighbors;
    uint64_t element = 1;
    for (const DenseArray& array : Arrays()) element = std::max<uint64_t>(element, array.empty.size());
    return box_.SetBox(accepted.index_box, element, file_->target());
  }

  absl::Status Add(const BrickBatch& batch) override {
    box_.Add(batch);
    if (!neighbors_.empty()) ForEachVoxel(batch, [this](const Voxel& voxel) { ijk_.push_back(voxel.ijk); });
    for (size_t n = 0; n < fields_.size(); ++n) {
      const std::vector<std::byte>& more = batch.fields[n].bytes;
      fields_[n].bytes.insert(fields_[n].bytes.end(), more.begin(), more.end());
    }
    return absl::OkStatus();
  }

  absl::Status Finish(const Summary&) override {
    box_.Sort();
    std::vector<ZipMember> members;
    for (const DenseArray& array : Arrays()) members.push_back(Dense(array, box_));
    if (!neighbors_.empty()) AddLinks(members);
    AddPlace(members);
    if (auto status = WriteZip(members, *file_); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  std::vector<DenseArray> Arrays() const {
    std::vector<DenseArray> arrays = {
        {"data", "'|u1'", 1, std::string(1, '\0'), [](uint64_t, char* element) { *element = 1; }}};
    for (const FieldValues& values : fields_) {
      const FieldFacts& facts = FactsOf(values.field);
      if (facts.is_of_links()) continue;
      std::string empty;
      for (size_t n = 0; n < facts.components; ++n) empty += EmptyOf(facts.type);
      arrays.push_back({facts.name, absl::StrCat("'", NumpyTypeOf(facts.field), "'"), facts.components, empty,
                        [&values, bytes = values.bytes_of_voxel()](uint64_t n, char* to) {
                          std::memcpy(to, BytesAt(values, n), bytes);
                        }});
    }
    return arrays;
  }

  // Adds fields of links: a row for each voxel, and none for other points of the box, which would be most of the file.
  void AddLinks(std::vector<ZipMember>& members) const {
    const uint64_t rows = ijk_.size(), columns = neighbors_.size();
    const auto integers = [](uint64_t count) { return NpyHeader("'<i4'", std::array<uint64_t, 2>{count, 3}); };
    members.push_back(Rows("ijk", integers(rows), ijk_));
    members.push_back(Rows("neighbors", integers(columns), neighbors_));
    for (const FieldValues& values : fields_) {
      if (!FactsOf(values.field).is_of_links()) continue;
      const std::string type = absl::StrCat("'", NumpyTypeOf(values.field), "'");
      members.push_back(
          Rows(NameOf(values.field), NpyHeader(type, std::array<uint64_t, 2>{rows, columns}), values.bytes));
    }
  }

  // Adds the arrays that say where the elements are.
  void AddPlace(std::vector<ZipMember>& members) const {
    const auto& [basis, origin, voxel_size] = grid_;
    const Vec3d low = grid_.ToWorld(box_.low());
    std::array<std::array<double, 4>, 4> affine{};
    for (size_t m = 0; m < 3; ++m) affine[m] = {basis.a[m], basis.b[m], basis.c[m], low[m]};
    affine[3][3] = 1;
    const std::array steps = {basis.a, basis.b, basis.c};
    const auto doubles = [](std::vector<uint64_t> shape) { return NpyHeader("'<f8'", shape); };
    members.push_back(Small("index_min", NpyHeader("'<i4'", std::array<uint64_t, 1>{3}) + BytesOf(box_.low())));
    members.push_back(Small("affine", doubles({4, 4}) + BytesOf(affine)));
    members.push_back(Small("basis", doubles({3, 3}) + BytesOf(steps)));
    members.push_back(Small("origin", doubles({3}) + BytesOf(origin)));
  }

  std::unique_ptr<AtomicFile> file_;
  GridTransform grid_;
  DenseBox box_;
  std::vector<FieldValues> fields_;  // in the order of Add
  std::vector<Vec3i> neighbors_;     // for fields of links
  std::vector<Vec3i> ijk_;           // of the voxels, with fields of links
};

}  // namespace

std::unique_ptr<Output> NewNpzOutput(std::unique_ptr<AtomicFile> file, const std::vector<Field>& fields) {
  return std::make_unique<NpzOutput>(std::move(file), fields);
}

}  // namespace latvox::client
