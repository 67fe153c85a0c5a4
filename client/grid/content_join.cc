#include "client/grid/content_join.h"

#include <algorithm>
#include <bit>
#include <compare>
#include <cstddef>
#include <span>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/grid/part_metadata.h"
#include "client/grid/steps_text.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

// A brick of a part.
struct PlaceInPart {
  Vec3i brick_ijk;
  uint32_t part;
  uint32_t brick;
  auto operator<=>(const PlaceInPart&) const = default;
};

// The voxels of a brick that come before the one with this bit.
uint64_t CountBefore(const Brick& brick, size_t bit) {
  uint64_t count = 0;
  for (size_t word = 0; word < bit / 64; ++word) count += static_cast<uint64_t>(std::popcount(brick.mask[word]));
  return count + static_cast<uint64_t>(std::popcount(brick.mask[bit / 64] & ((uint64_t{1} << bit % 64) - 1)));
}

bool HasVoxel(const Brick& brick, size_t bit) { return (brick.mask[bit / 64] >> bit % 64 & 1) != 0; }

std::string NamesOf(const GridContent& content) {
  const auto name = [&](std::string* out, const FieldValues& values) {
    *out += NameOf(values.field);
    if (!values.labels.empty()) absl::StrAppend(out, " of ", absl::StrJoin(values.labels, " "));
    if (values.neighbors > 0) absl::StrAppend(out, " to ", StepsText(content.neighbors));
  };
  return content.fields.empty() ? "absent" : absl::StrJoin(content.fields, ",", name);
}

class Joiner {
 public:
  Joiner(const std::vector<PartContent>& parts, bool disjoint) : parts_(parts), disjoint_(disjoint) {
    for (const FieldValues& values : parts.front().content.fields) {
      joined_.fields.push_back({values.field, {}, values.neighbors, values.labels});
    }
    joined_.neighbors = parts.front().content.neighbors;
  }

  absl::StatusOr<JoinedContent> Join() && {
    if (auto status = CheckFields(); !status.ok()) return status;
    const std::vector<PlaceInPart> places = Sorted();
    for (size_t begin = 0, end = 0; begin < places.size(); begin = end) {
      while (end < places.size() && places[end].brick_ijk == places[begin].brick_ijk) ++end;
      if (auto status = AddBrick(std::span(places).subspan(begin, end - begin)); !status.ok()) return status;
    }
    return std::move(joined_);
  }

 private:
  absl::Status CheckFields() const {
    const PartContent& first = parts_.front();
    const auto same = [](const FieldValues& a, const FieldValues& b) {
      return a.field == b.field && a.labels == b.labels;
    };
    for (const auto& [path, content] : parts_) {
      if (std::ranges::equal(content.fields, first.content.fields, same) &&
          content.neighbors == first.content.neighbors) {
        continue;
      }
      return absl::InvalidArgumentError(absl::StrCat(path, ": its fields are ", NamesOf(content), ", but ",
                                                     NamesOf(first.content), " in ", first.path));
    }
    return absl::OkStatus();
  }

  // Counts the voxels before each brick on the way.
  std::vector<PlaceInPart> Sorted() {
    std::vector<PlaceInPart> places;
    for (uint32_t part = 0; part < parts_.size(); ++part) {
      std::vector<uint64_t>& before = before_.emplace_back();
      uint64_t voxels = 0;
      for (const Brick& brick : parts_[part].content.file.bricks) {
        places.push_back({brick.brick_ijk, part, static_cast<uint32_t>(before.size())});
        before.push_back(voxels);
        voxels += CountVoxels(brick);
      }
    }
    std::ranges::sort(places);
    return places;
  }

  const Brick& BrickAt(const PlaceInPart& place) const { return parts_[place.part].content.file.bricks[place.brick]; }

  // The bytes of a voxel's field.
  std::span<const std::byte> ValueAt(const PlaceInPart& place, size_t field, size_t bit) const {
    const FieldValues& values = parts_[place.part].content.fields[field];
    const uint64_t voxel = before_[place.part][place.brick] + CountBefore(BrickAt(place), bit);
    return std::span(values.bytes).subspan(voxel * values.bytes_of_voxel(), values.bytes_of_voxel());
  }

  absl::Status AddBrick(std::span<const PlaceInPart> places) {
    if (disjoint_ && places.size() > 1) {
      return SharedBrick(parts_[places[1].part].path, parts_[places[0].part].path, places[0].brick_ijk);
    }
    Brick joined{places[0].brick_ijk, {}};
    for (const PlaceInPart& place : places) {
      for (size_t word = 0; word < joined.mask.size(); ++word) joined.mask[word] |= BrickAt(place).mask[word];
    }
    joined_.bricks.push_back(joined);
    joined_.shared_bricks += places.size() - 1;
    if (places.size() == 1) return AddValues(places[0], CountVoxels(joined)), absl::OkStatus();
    for (size_t bit = 0; bit < 512; ++bit) {
      if (!HasVoxel(joined, bit)) continue;
      if (auto status = AddVoxel(places, bit); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  // Appends the values of all voxels of a brick.
  void AddValues(const PlaceInPart& place, size_t voxels) {
    for (size_t field = 0; field < joined_.fields.size(); ++field) {
      const FieldValues& values = parts_[place.part].content.fields[field];
      const size_t bytes = values.bytes_of_voxel();
      const auto begin = values.bytes.begin() + static_cast<ptrdiff_t>(before_[place.part][place.brick] * bytes);
      std::vector<std::byte>& to = joined_.fields[field].bytes;
      to.insert(to.end(), begin, begin + static_cast<ptrdiff_t>(voxels * bytes));
    }
  }

  absl::Status AddVoxel(std::span<const PlaceInPart> places, size_t bit) {
    const PlaceInPart* first = nullptr;
    for (const PlaceInPart& place : places) {
      if (!HasVoxel(BrickAt(place), bit)) continue;
      for (size_t field = 0; field < joined_.fields.size(); ++field) {
        const auto value = ValueAt(place, field, bit);
        std::vector<std::byte>& bytes = joined_.fields[field].bytes;
        if (first == nullptr) {
          bytes.insert(bytes.end(), value.begin(), value.end());
        } else if (!std::ranges::equal(value, ValueAt(*first, field, bit))) {
          return Differ(place, *first, field, bit);
        }
      }
      if (first == nullptr) first = &place;
    }
    return absl::OkStatus();
  }

  absl::Status Differ(const PlaceInPart& place, const PlaceInPart& first, size_t field, size_t bit) const {
    const auto n = static_cast<int32_t>(bit);
    const Vec3i& brick = place.brick_ijk;
    return absl::InvalidArgumentError(absl::StrCat(parts_[place.part].path, ": voxel ", brick[0] * 8 + (n >> 6), ",",
                                                   brick[1] * 8 + (n >> 3 & 7), ",", brick[2] * 8 + (n & 7),
                                                   " has another ", NameOf(joined_.fields[field].field), " than in ",
                                                   parts_[first.part].path));
  }

  const std::vector<PartContent>& parts_;
  const bool disjoint_;
  std::vector<std::vector<uint64_t>> before_;  // for each part, the number of voxels before each brick
  JoinedContent joined_;
};

}  // namespace

absl::StatusOr<JoinedContent> JoinContents(const std::vector<PartContent>& parts, bool disjoint) {
  return Joiner(parts, disjoint).Join();
}

}  // namespace latvox::client
