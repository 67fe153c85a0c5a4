#include "core/solid/label_sweep.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "core/brick/brick.h"

namespace latvox {
namespace {

constexpr size_t kSide = kTileSide, kRows = kSide * kSide;
constexpr uint32_t kNowhere = std::numeric_limits<uint32_t>::max();

}  // namespace

void LabelSweep::Begin(InteriorRule rule, size_t labels) {
  rule_ = rule;
  for (Changes* changes : {&starts_, &along_i_, &along_j_, &along_k_}) changes->clear();
  places_.resize(labels, kNowhere);
}

// The labels of a tile are few, so their places are close to each other.
void LabelSweep::NumberLabels() {
  present_.clear();
  for (const Changes* changes : {&starts_, &along_i_, &along_j_, &along_k_}) {
    for (const Change change : *changes) {
      uint32_t& place = places_[RankOf(change)];
      if (place == kNowhere) present_.push_back(RankOf(change));
      place = 0;
    }
  }
  std::sort(present_.begin(), present_.end());
  for (uint32_t n = 0; n < present_.size(); ++n) places_[present_[n]] = n;
  sums_.assign(present_.size(), 0);
  inside_.assign(present_.size() / 64 + 1, 0);
}

void LabelSweep::ForgetLabels() {
  for (const uint32_t rank : present_) places_[rank] = kNowhere;
}

// By rows, then along each row. Most rows have two crossings.
void LabelSweep::SortRows() {
  row_ends_.assign(kRows + 1, 0);
  for (const Change change : along_k_) ++row_ends_[(change >> kRowShift) + 1];
  for (size_t row = 0; row < kRows; ++row) row_ends_[row + 1] += row_ends_[row];
  sorted_.resize(along_k_.size());
  for (const Change change : along_k_) sorted_[row_ends_[change >> kRowShift]++] = change;
  row_ends_.pop_back();  // an entry has moved to the row's end
  for (size_t row = 0, first = 0; row < kRows; first = row_ends_[row++]) {
    if (row_ends_[row] - first > 1) std::sort(sorted_.data() + first, sorted_.data() + row_ends_[row]);
  }
}

void LabelSweep::Apply(Change change, int32_t sign) {
  const uint32_t place = places_[RankOf(change)];
  int32_t& sum = sums_[place];
  const bool was_inside = IsInside(rule_, sum);
  sum += (change & 1) != 0 ? sign : -sign;
  if (IsInside(rule_, sum) != was_inside) inside_[place >> 6] ^= uint64_t{1} << (place & 63);
}

void LabelSweep::Apply(std::span<const Change> changes, int32_t sign) {
  for (const Change change : changes) Apply(change, sign);
}

uint32_t LabelSweep::Top(std::span<const uint32_t> numbers) const {
  for (size_t n = 0; n < inside_.size(); ++n) {
    if (inside_[n] != 0) return numbers[present_[n << 6 | static_cast<size_t>(std::countr_zero(inside_[n]))]];
  }
  return kNoLabel;
}

uint64_t LabelSweep::FinishRow(std::span<const Change> changes, std::span<const uint32_t> numbers,
                               std::vector<LabelRun>& runs) {
  uint64_t bits = 0;
  uint32_t last = kNoLabel;
  auto next = changes.begin();
  for (uint32_t k = 0;; k = AtOf(*next)) {
    for (; next != changes.end() && AtOf(*next) == k; ++next) Apply(*next, 1);
    const uint32_t top = Top(numbers);
    if (k == 0 || top != last) runs.push_back({k, top});
    if ((top == kNoLabel) != (last == kNoLabel)) bits ^= ~uint64_t{0} << k;
    last = top;
    if (next == changes.end()) break;
  }
  Apply(changes, -1);
  return bits;
}

void LabelSweep::Finish(std::span<const uint32_t> numbers, std::span<uint64_t> rows, LabelRuns& labels) {
  NumberLabels();
  Apply(starts_, 1);
  labels.clear();
  if (along_i_.empty() && along_j_.empty() && along_k_.empty()) {
    labels.runs.push_back({0, Top(numbers)});
    std::fill(rows.begin(), rows.end(), labels.runs.front().label == kNoLabel ? 0 : ~uint64_t{0});
  } else {
    SortRows();
    std::sort(along_i_.begin(), along_i_.end());
    std::sort(along_j_.begin(), along_j_.end());
    labels.starts.reserve(kRows + 1);
    size_t next_i = 0, next_j = 0, next_k = 0;
    for (size_t i = 0; i < kSide; ++i) {
      for (; next_i < along_i_.size() && LineOf(along_i_[next_i]) == i; ++next_i) Apply(along_i_[next_i], 1);
      const size_t first_j = next_j;
      for (size_t j = 0; j < kSide; ++j) {
        for (; next_j < along_j_.size() && LineOf(along_j_[next_j]) == (i << 7 | j); ++next_j) {
          Apply(along_j_[next_j], 1);
        }
        const size_t row = i * kSide + j, end_k = row_ends_[row];
        labels.starts.push_back(static_cast<uint32_t>(labels.runs.size()));
        rows[row] = FinishRow(std::span(sorted_).subspan(next_k, end_k - next_k), numbers, labels.runs);
        next_k = end_k;
      }
      Apply(std::span(along_j_).subspan(first_j, next_j - first_j), -1);
    }
    labels.starts.push_back(static_cast<uint32_t>(labels.runs.size()));
  }
  ForgetLabels();
}

uint64_t LabelSweep::FinishLine(std::span<const uint32_t> numbers, std::vector<LabelRun>& runs) {
  NumberLabels();
  std::sort(along_k_.begin(), along_k_.end());
  const uint64_t bits = FinishRow(along_k_, numbers, runs);
  ForgetLabels();
  along_k_.clear();
  return bits;
}

}  // namespace latvox
