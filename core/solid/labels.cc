#include "core/solid/labels.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_payload.h"
#include "core/brick/label_runs.h"

namespace latvox {
namespace {

static_assert(kMaxLabels - 1 <= std::numeric_limits<uint16_t>::max());

constexpr size_t kPiece = 4096;  // triangles between two looks at the stop signal

absl::Status TooMany(const LabelRequest& request) {
  const std::string name = NameOf(request.field), limit = absl::StrCat(request.most);
  return WithField(absl::ResourceExhaustedError(
                       absl::StrCat(request.name, " ", name, ": the mesh has more than ", limit, " labels")),
                   request.name, name, limit);
}

// Sorts labels by priority; the ranks of the labels as they stood before.
std::vector<uint16_t> Rank(std::span<const uint32_t> priority, std::vector<uint32_t>& numbers) {
  absl::flat_hash_map<uint32_t, size_t> places;
  for (size_t n = 0; n < priority.size(); ++n) places[priority[n]] = n;
  const auto place_of = [&](uint32_t number) {
    const auto found = places.find(number);
    return std::pair(found == places.end() ? priority.size() : found->second, ~number);
  };
  std::vector<uint16_t> order(numbers.size()), ranks(numbers.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::sort(order, {}, [&](uint16_t n) { return place_of(numbers[n]); });
  std::vector<uint32_t> sorted;
  for (const uint16_t n : order) {
    ranks[n] = static_cast<uint16_t>(sorted.size());
    sorted.push_back(numbers[n]);
  }
  numbers = std::move(sorted);
  return ranks;
}

}  // namespace

absl::StatusOr<Labels> MakeLabels(const SnappedMesh& mesh, const LabelRequest& request,
                                  std::span<const uint32_t> of_vertices, size_t stride, size_t place, StopSignal stop) {
  Labels labels{request.field, {}, {}};
  labels.of_triangles.resize(mesh.triangles.size());
  absl::flat_hash_map<uint32_t, uint16_t> places;  // in labels.numbers
  uint32_t last = kNoLabel;                        // triangles of a label mostly follow each other
  const auto number = [numbers = of_vertices.data() + place, stride](uint32_t v) { return numbers[v * stride]; };
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (t % kPiece == 0 && stop.Stopped()) return labels;
    const auto& [a, b, c] = mesh.triangles[t];
    const uint32_t label = std::min(std::min(number(a), number(b)), number(c));
    if (label == last) {
      labels.of_triangles[t] = labels.of_triangles[t - 1];
      continue;
    }
    last = label;
    const auto [found, is_new] = places.try_emplace(label, static_cast<uint16_t>(places.size()));
    if (is_new) labels.numbers.push_back(label);
    if (labels.numbers.size() > request.most) return TooMany(request);
    labels.of_triangles[t] = found->second;
  }
  const std::vector<uint16_t> ranks = Rank(request.priority, labels.numbers);
  for (size_t t = 0; t < labels.of_triangles.size(); ++t) {
    if (t % kPiece == 0 && stop.Stopped()) return labels;
    labels.of_triangles[t] = ranks[labels.of_triangles[t]];
  }
  return labels;
}

absl::StatusOr<std::vector<uint32_t>> FractionLabelsOf(const Labels& labels, const std::vector<uint32_t>& asked) {
  if (!asked.empty()) return asked;
  const size_t count = labels.numbers.size();
  if (count > kMostFractionLabels) {
    return WithField(
        absl::ResourceExhaustedError(absl::StrCat("fraction_labels: the mesh has ", count, " labels, the limit is ",
                                                  kMostFractionLabels, "; the request may list some of them")),
        "fraction_labels", absl::StrCat(count), absl::StrCat(kMostFractionLabels));
  }
  std::vector<uint32_t> all = labels.numbers;
  std::ranges::sort(all);
  return all;
}

Labels::Groups Labels::ByRank(StopSignal stop) const {
  Groups groups{std::vector<uint32_t>(of_triangles.size()), std::vector<size_t>(numbers.size() + 1)};
  const auto for_each = [&](auto&& f) {
    for (uint32_t t = 0; t < of_triangles.size() && (t % kPiece != 0 || !stop.Stopped()); ++t) f(t, of_triangles[t]);
  };
  for_each([&](uint32_t, size_t rank) { ++groups.begins[rank + 1]; });
  std::partial_sum(groups.begins.begin(), groups.begins.end(), groups.begins.begin());
  std::vector<size_t> next(groups.begins.begin(), groups.begins.end() - 1);
  if (!stop.Stopped()) for_each([&](uint32_t t, size_t rank) { groups.order[next[rank]++] = t; });
  return groups;
}

}  // namespace latvox
