#include "client/tool/output/npz_output.h"

#include <array>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/tool/output/dense_box.h"
#include "client/tool/output/npy_header.h"
#include "client/tool/output/zip_writer.h"

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

// One array over all lattice points of a box.
struct Field {
  std::string name, type;  // type: as in NpyHeader
  std::string empty;       // bytes of an element that is not a voxel
  std::function<void(uint64_t n, char* element)> put;
};

ZipMember Dense(const Field& field, DenseBox& box) {
  std::vector<uint64_t> shape(box.shape().begin(), box.shape().end());
  if (field.empty.size() == 3) shape.push_back(3);  // a color
  const std::string header = NpyHeader(field.type, shape);
  const uint64_t bytes = header.size() + box.shape()[0] * box.shape()[1] * box.shape()[2] * field.empty.size();
  const auto head = std::make_shared<std::string>(header);
  const auto rows = std::make_shared<DenseRows>(box, field.empty, field.put);
  return {field.name + ".npy", bytes, [head, rows](std::string& chunk) {
            head->empty() ? rows->Next(chunk) : static_cast<void>(chunk = std::exchange(*head, {}));
          }};
}

class NpzOutput final : public Output {
 public:
  NpzOutput(std::unique_ptr<AtomicFile> file, bool band, const std::vector<Attribute>& attributes)
      : file_(std::move(file)), band_(band), attributes_(attributes) {}

  absl::Status Begin(const Accepted& accepted) override {
    grid_ = accepted.grid;
    uint64_t element = 1;
    for (const Field& field : Fields()) element = std::max<uint64_t>(element, field.empty.size());
    return box_.SetBox(accepted.index_box, element, file_->target());
  }

  absl::Status Add(const BrickBatch& batch) override {
    box_.Add(batch);
    distances_.insert(distances_.end(), batch.values.begin(), batch.values.end());
    numbers_.insert(numbers_.end(), batch.attributes.begin(), batch.attributes.end());
    return absl::OkStatus();
  }

  absl::Status Finish(const Summary&) override {
    box_.Sort();
    std::vector<ZipMember> members;
    for (const Field& field : Fields()) members.push_back(Dense(field, box_));
    AddPlace(members);
    if (auto status = WriteZip(members, *file_); !status.ok()) return status;
    return file_->Sync();
  }

  absl::Status Commit() override { return file_->Commit(); }

 private:
  std::vector<Field> Fields() const {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    if (band_) {
      return {{"data", "'<f4'", BytesOf(nan), [this](uint64_t n, char* to) { std::memcpy(to, &distances_[n], 4); }}};
    }
    std::vector<Field> fields = {
        {"data", "'|u1'", std::string(1, '\0'), [](uint64_t, char* element) { *element = 1; }}};
    for (size_t m = 0; m < attributes_.size(); ++m) {
      const auto number = [this, m](uint64_t n) { return numbers_[n * attributes_.size() + m]; };
      if (attributes_[m] == Attribute::kColor) {
        fields.push_back({"color", "'|u1'", std::string(3, '\0'), [number](uint64_t n, char* to) {
                            for (int shift = 16; shift >= 0; shift -= 8) *to++ = static_cast<char>(number(n) >> shift);
                          }});
      } else {
        fields.push_back({NameOf(attributes_[m]), "'<i4'", BytesOf(int32_t{-1}), [number](uint64_t n, char* to) {
                            const uint32_t value = number(n);
                            std::memcpy(to, &value, sizeof(value));
                          }});
      }
    }
    return fields;
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
  const bool band_;
  const std::vector<Attribute> attributes_;
  GridTransform grid_;
  DenseBox box_;
  std::vector<float> distances_;   // in the order of Add
  std::vector<uint32_t> numbers_;  // likewise, one for each attribute
};

}  // namespace

std::unique_ptr<Output> NewNpzOutput(std::unique_ptr<AtomicFile> file, bool band,
                                     const std::vector<Attribute>& attributes) {
  return std::make_unique<NpzOutput>(std::move(file), band, attributes);
}

}  // namespace latvox::client
