#include "client/tool/output/dense_fields.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <optional>

#include "absl/strings/str_cat.h"
#include "client/tool/output/field_columns.h"

namespace latvox::client {
namespace {

template <class T>
std::string RawBytesOf(const T& value) {
  return {reinterpret_cast<const char*>(&value), sizeof(value)};
}

// Returns the bytes of a component where there is no voxel.
std::string EmptyOf(NumberType type) {
  if (type == NumberType::kFloat32) return RawBytesOf(std::numeric_limits<float>::quiet_NaN());
  if (type == NumberType::kUint32) return RawBytesOf(int32_t{-1});
  return type == NumberType::kUint16 ? RawBytesOf(uint16_t{0}) : RawBytesOf(uint8_t{0});
}

}  // namespace

DenseFields::DenseFields(const std::vector<Field>& fields, DenseOrder order, const BoxShape& shape,
                         const IndexBox& without_voxels, bool are_joined)
    : shape_(shape), without_voxels_(without_voxels), are_joined_(are_joined), box_(order) {
  for (const Field field : fields) fields_.push_back({field, {}});
}

absl::Status DenseFields::Begin(const Accepted& accepted, const std::string& target) {
  target_ = target;
  grid_ = accepted.grid;
  for (FieldValues& values : fields_) values = accepted.NoValues(values.field);
  std::optional<IndexBox> box = accepted.index_box;
  if (shape_.dims) {
    box = IndexBox{{0, 0, 0}, *shape_.dims};  // their number is certain, their place is not
  } else if (box) {
    const auto shaped = ShapedBox(*box, shape_, target);
    if (!shaped.ok()) return shaped.status();
    box = *shaped;
  }
  return SetBox(box);
}

absl::Status DenseFields::SetBox(const std::optional<IndexBox>& box) {
  uint64_t element = 1;
  if (are_joined_) element = Joined(Arrays()).empty.size();
  for (const DenseArray& array : Arrays()) element = std::max<uint64_t>(element, array.empty.size());
  return box_.SetBox(box, element, target_);
}

absl::Status DenseFields::Add(const BrickBatch& batch) {
  box_.Add(batch);
  for (FieldValues& values : fields_) {
    const std::vector<std::byte>& more = FindField(batch.fields, values.field)->bytes;
    values.bytes.insert(values.bytes.end(), more.begin(), more.end());
  }
  for (const Brick& brick : batch.bricks) voxels_.Add(brick);
  return voxels_.box() ? ShapedBox(*voxels_.box(), shape_, target_).status() : absl::OkStatus();
}

absl::Status DenseFields::Finish() {
  box_.Sort();
  if (!voxels_.box() && !shape_.dims) return SetBox(without_voxels_);
  const auto box = ShapedBox(voxels_.box().value_or(IndexBox{}), shape_, target_);
  return box.ok() ? SetBox(*box) : box.status();
}

std::vector<DenseArray> DenseFields::Arrays() const {
  std::vector<DenseArray> arrays = {
      {"data", NumberType::kUint8, 1, std::string(1, '\0'), [](uint64_t, char* element) { *element = 1; }}};
  for (const FieldValues& values : fields_) {
    const FieldFacts& facts = FactsOf(values.field);
    const bool is_label = facts.type == NumberType::kUint32 && facts.field != Field::kLinkCrossings;
    const auto add = [&](const std::string& name, size_t first, size_t components) {
      std::string empty;
      for (size_t n = 0; n < components; ++n) empty += EmptyOf(facts.type);
      const size_t skipped = first * EmptyOf(facts.type).size();
      arrays.push_back({name, facts.type, components, empty,
                        [&values, skipped, bytes = empty.size()](uint64_t n, char* to) {
                          std::memcpy(to, BytesAt(values, n) + skipped, bytes);
                        },
                        is_label});
    };
    if (!facts.is_of_labels()) add(facts.name, 0, values.components());
    for (size_t n = 0; n < values.labels.size(); ++n) add(FractionName(values.labels[n]), n, 1);
  }
  return arrays;
}

DenseArray Joined(std::vector<DenseArray> arrays) {
  if (arrays.size() > 1) arrays.erase(arrays.begin());
  DenseArray joined = arrays.front();
  for (size_t n = 1; n < arrays.size(); ++n) {
    absl::StrAppend(&joined.name, ",", arrays[n].name);
    joined.components += arrays[n].components;
    joined.empty += arrays[n].empty;
  }
  joined.put = [arrays](uint64_t n, char* to) {
    for (const DenseArray& array : arrays) {
      array.put(n, to);
      to += array.empty.size();
    }
  };
  return joined;
}

}  // namespace latvox::client
