#include "client/tool/cli/voxel_difference.h"

#include <algorithm>
#include <bit>
#include <map>

#include "absl/strings/match.h"
#include "absl/strings/str_format.h"
#include "client/tool/cli/brick_pairs.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

using Mask = decltype(Brick::mask);

std::string AllDigits(const Vec3d& v) { return absl::StrFormat("%.17g,%.17g,%.17g", v[0], v[1], v[2]); }

class FieldComparison {
 public:
  void Add(const Vec3i& brick_ijk, const Mask& a, const Mask& b) {
    for (const bool in_a : {true, false}) {
      Brick only{brick_ijk, {}};
      for (size_t x = 0; x < 8; ++x) only.mask[x] = in_a ? a[x] & ~b[x] : b[x] & ~a[x];
      ForEachVoxel(only, [&](const Vec3i& ijk) { AddVoxel(ijk, in_a); });
    }
    for (size_t x = 0; x < 8; ++x) found_.both += static_cast<uint64_t>(std::popcount(a[x] & b[x]));
  }

  VoxelDifference found() const { return found_; }

 private:
  void AddVoxel(const Vec3i& ijk, bool in_a) {
    ++(in_a ? found_.only_a : found_.only_b);
    if (found_.first.size() < VoxelDifference::kFirst) found_.first.emplace_back(ijk, in_a);
    if (!found_.box) found_.box = {ijk, ijk};
    for (size_t m = 0; m < 3; ++m) {
      found_.box->min[m] = std::min(found_.box->min[m], ijk[m]);
      found_.box->max[m] = std::max(found_.box->max[m], ijk[m] + 1);
    }
  }

  VoxelDifference found_;
};

}  // namespace

double VoxelDifference::Jaccard() const {
  const uint64_t all = only_a + only_b + both;
  return all == 0 ? 1 : static_cast<double>(both) / static_cast<double>(all);
}

VoxelDifference CompareVoxels(std::span<const Brick> a, std::span<const Brick> b) {
  constexpr Mask kNone{};
  FieldComparison comparison;
  ForEachPair(a, b, [&](const Brick* of_a, const Brick* of_b) {
    comparison.Add((of_a ? of_a : of_b)->brick_ijk, of_a ? of_a->mask : kNone, of_b ? of_b->mask : kNone);
  });
  return comparison.found();
}

std::vector<FieldDifference> CompareFields(const GridFileInfo& a, const GridFileInfo& b) {
  const auto fields = [](const GridFileInfo& info) {
    std::map<std::string, std::string> words(info.metadata.begin(), info.metadata.end());
    std::erase_if(words, [](const auto& word) { return absl::StartsWith(word.first, "file_"); });
    for (const char* name : {"latvox_basis", "latvox_origin", "latvox_voxel_size", "latvox_request"}) words.erase(name);
    words["step in i"] = AllDigits(info.transform.basis.a);
    words["step in j"] = AllDigits(info.transform.basis.b);
    words["step in k"] = AllDigits(info.transform.basis.c);
    words["origin"] = AllDigits(info.transform.origin);
    return words;
  };
  const auto of_a = fields(a), of_b = fields(b);
  std::map<std::string, FieldDifference> all;
  for (const auto& [name, word] : of_a) all[name] = {name, word, ""};
  for (const auto& [name, word] : of_b) {
    all[name].name = name;
    all[name].b = word;
  }
  std::vector<FieldDifference> different;
  for (const auto& [name, field] : all) {
    if (field.a != field.b) different.push_back(field);
  }
  return different;
}

}  // namespace latvox::client
