#include "client/tool/confined/content_wire.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "client/internal/printable.h"

namespace latvox::client {
namespace {

constexpr uint64_t kChunk = uint64_t{1} << 20;                          // elements
constexpr int32_t kLowBrick = std::numeric_limits<int32_t>::min() / 8;  // of voxels with 32 bits
constexpr int32_t kHighBrick = std::numeric_limits<int32_t>::max() / 8;

absl::Status Nonsense() { return absl::DataLossError("the bytes are no content"); }

class Sender {
 public:
  explicit Sender(const SendBytes& send) : send_(send) {}

  template <class T>
  void Put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    send_(&value, sizeof(value));
  }
  template <class Vector>
  void PutAll(const Vector& all) {
    Put(uint64_t{all.size()});
    send_(all.data(), all.size() * sizeof(all[0]));
  }
  void Put(const GridFileInfo& info) {
    PutAll(info.name);
    PutAll(info.value_type);
    Put(info.transform);
    Put(info.active_voxels);
    Put(info.active_box.has_value());
    Put(info.active_box.value_or(IndexBox{}));
    Put(uint64_t{info.metadata.size()});
    for (const auto& [name, value] : info.metadata) {
      PutAll(name);
      PutAll(value);
    }
  }

 private:
  const SendBytes& send_;
};

// After the first error, it receives nothing more.
class Receiver {
 public:
  explicit Receiver(const ReceiveBytes& receive) : receive_(receive) {}

  const absl::Status& status() const { return status_; }

  template <class T>
  T Get() {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>);
    T value{};
    if (status_.ok()) status_ = receive_(&value, sizeof(value));
    return value;
  }
  bool GetBool() {
    const auto byte = Get<uint8_t>();
    Require(byte <= 1);
    return byte == 1;
  }
  template <class Vector>
  Vector GetAll() {
    Vector all;
    for (auto left = Get<uint64_t>(); status_.ok() && left > 0;) {
      const uint64_t now = std::min(left, kChunk), before = all.size();
      all.resize(before + now);
      status_ = receive_(all.data() + before, now * sizeof(all[0]));
      left -= now;
    }
    return all;
  }
  void Require(bool holds) {
    if (!holds && status_.ok()) status_ = Nonsense();
  }

  GridFileInfo GetInfo() {
    GridFileInfo info;
    info.name = GetAll<std::string>();
    info.value_type = GetAll<std::string>();
    info.transform = Get<GridTransform>();
    info.active_voxels = Get<uint64_t>();
    const bool has_box = GetBool();
    const auto box = Get<IndexBox>();
    if (has_box) info.active_box = box;
    for (auto left = Get<uint64_t>(); status_.ok() && left > 0; --left) {
      auto name = GetAll<std::string>();
      info.metadata.emplace_back(std::move(name), GetAll<std::string>());
    }
    return info;
  }

 private:
  const ReceiveBytes& receive_;
  absl::Status status_;
};

bool AreFinite(const GridTransform& transform) {
  double sum = std::abs(transform.voxel_size);
  for (const Vec3d& v : {transform.basis.a, transform.basis.b, transform.basis.c, transform.origin}) {
    for (const double x : v) sum += std::abs(x);
  }
  return std::isfinite(sum);
}

bool IsInRange(const Brick& brick) {
  const auto fits = [](int32_t x) { return x >= kLowBrick && x <= kHighBrick; };
  return std::all_of(brick.brick_ijk.begin(), brick.brick_ijk.end(), fits);
}

// Returns the number of voxels, or nothing if the bricks are not as GridFile describes them.
std::optional<uint64_t> CountVoxels(const std::vector<Brick>& bricks) {
  uint64_t voxels = 0;
  for (size_t n = 0; n < bricks.size(); ++n) {
    uint64_t count = 0;
    for (const uint64_t word : bricks[n].mask) count += static_cast<uint64_t>(std::popcount(word));
    if (count == 0 || !IsInRange(bricks[n])) return std::nullopt;
    if (n > 0 && !(bricks[n - 1].brick_ijk < bricks[n].brick_ijk)) return std::nullopt;
    voxels += count;
  }
  return voxels;
}

// Returns whether the box is that of the bricks, as far as whole bricks tell.
bool IsBoxOf(const std::vector<Brick>& bricks, const IndexBox& box) {
  for (size_t n = 0; n < 3; ++n) {
    const auto less = [n](const Brick& a, const Brick& b) { return a.brick_ijk[n] < b.brick_ijk[n]; };
    const auto [low, high] = std::minmax_element(bricks.begin(), bricks.end(), less);
    if (box.min[n] >> 3 != low->brick_ijk[n] || (box.max[n] - 1) >> 3 != high->brick_ijk[n]) return false;
  }
  return true;
}

// Returns whether the vectors ascend, and each has its opposite among them.
bool AreNeighbors(const std::vector<Vec3i>& neighbors) {
  if (neighbors.size() > kMostNeighbors || neighbors.size() % 2 != 0) return false;
  for (size_t n = 0; n < neighbors.size(); ++n) {
    if (n > 0 && !(neighbors[n - 1] < neighbors[n])) return false;
    const Vec3i &q = neighbors[n], &opposite = neighbors[neighbors.size() - 1 - n];
    for (size_t m = 0; m < 3; ++m) {
      if (int64_t{q[m]} + opposite[m] != 0) return false;
    }
  }
  return true;
}

// A link that the mesh does not cross has no share.
bool IsFloatOf(Field field, float x) {
  if (field == Field::kLinks) return std::isnan(x) || (x > 0 && x <= 1);
  return std::isfinite(x);
}

bool IsOfLinks(const FieldValues& values) { return FactsOf(values.field).is_of_links(); }

bool AreValues(const FieldValues& values, uint64_t voxels) {
  const FieldFacts& facts = FactsOf(values.field);
  if (facts.is_of_links() && values.neighbors == 0) return false;
  if (facts.is_of_labels() == values.labels.empty() || values.labels.size() > kMostFractionLabels) return false;
  const size_t bytes = values.bytes_of_voxel();
  if (values.bytes.size() / bytes != voxels || values.bytes.size() % bytes != 0) return false;
  const auto is_good = [&values](float x) { return IsFloatOf(values.field, x); };
  const std::span<const float> floats = values.As<float>();
  return facts.type != NumberType::kFloat32 || std::all_of(floats.begin(), floats.end(), is_good);
}

bool IsContent(const GridContent& content) {
  const GridFileInfo& info = content.file.info;
  if (CountVoxels(content.file.bricks) != info.active_voxels) return false;
  if (!AreFinite(info.transform) || info.active_box.has_value() != (info.active_voxels > 0)) return false;
  if (info.active_box && !IsBoxOf(content.file.bricks, *info.active_box)) return false;
  if (!AreNeighbors(content.neighbors)) return false;
  if (content.neighbors.empty() == std::any_of(content.fields.begin(), content.fields.end(), IsOfLinks)) return false;
  const bool has_distances = FindField(content.fields, Field::kDistance) != nullptr;
  if (content.distances.has_value() != has_distances) return false;
  if (content.distances && !std::isfinite(content.distances->most)) return false;
  const auto are_values = [&](const FieldValues& values) { return AreValues(values, info.active_voxels); };
  if (!std::all_of(content.fields.begin(), content.fields.end(), are_values)) return false;
  const auto not_before = [](const FieldValues& a, const FieldValues& b) { return a.field >= b.field; };
  return std::adjacent_find(content.fields.begin(), content.fields.end(), not_before) == content.fields.end();
}

// Both kinds are about the input, whatever the sender says.
absl::Status GetError(Receiver& receiver) {
  const bool is_exhausted = receiver.GetBool();
  const std::string message = Printable(receiver.GetAll<std::string>());
  if (!receiver.status().ok()) return receiver.status();
  return is_exhausted ? absl::ResourceExhaustedError(message) : absl::InvalidArgumentError(message);
}

}  // namespace

void SendContent(const absl::StatusOr<GridContent>& content, const SendBytes& send) {
  Sender sender(send);
  sender.Put(content.ok());
  if (!content.ok()) {
    sender.Put(content.status().code() == absl::StatusCode::kResourceExhausted);
    return sender.PutAll(std::string(content.status().message()));
  }
  sender.Put(content->file.info);
  sender.PutAll(content->file.bricks);
  sender.Put(content->is_band);
  sender.Put(content->distances.has_value());
  sender.Put(content->distances.value_or(DistanceRange{}).most);
  sender.Put(content->distances.value_or(DistanceRange{}).is_signed);
  sender.PutAll(content->neighbors);
  sender.Put(uint64_t{content->fields.size()});
  for (const FieldValues& values : content->fields) {
    sender.Put(values.field);
    sender.PutAll(values.bytes);
    sender.PutAll(values.labels);
  }
}

absl::StatusOr<GridContent> ReceiveContent(bool facts_alone, const ReceiveBytes& receive) {
  Receiver receiver(receive);
  if (!receiver.GetBool()) return GetError(receiver);
  GridContent content{.file = {receiver.GetInfo(), receiver.GetAll<std::vector<Brick>>()},
                      .is_band = receiver.GetBool()};
  const bool has_distances = receiver.GetBool();
  DistanceRange range;
  range.most = receiver.Get<double>();
  range.is_signed = receiver.GetBool();
  if (has_distances) content.distances = range;
  content.neighbors = receiver.GetAll<std::vector<Vec3i>>();
  for (auto left = receiver.Get<uint64_t>(); receiver.status().ok() && left > 0; --left) {
    const auto field = receiver.Get<Field>();
    receiver.Require(static_cast<size_t>(field) < kFields.size());
    auto bytes = receiver.GetAll<std::vector<std::byte>>();
    const bool is_of_links = receiver.status().ok() && FactsOf(field).is_of_links();
    content.fields.push_back({field, std::move(bytes), is_of_links ? content.neighbors.size() : 0,
                              receiver.GetAll<std::vector<uint32_t>>()});
  }
  if (!receiver.status().ok()) return receiver.status();
  if (!facts_alone && !IsContent(content)) return Nonsense();
  return content;
}

}  // namespace latvox::client
