#include "client/grid/brick_merge.h"

#include "client/grid/part_metadata.h"

namespace latvox::client {
namespace {

constexpr uint64_t kTick = 1 << 12;  // bricks, some 1 ms

}  // namespace

BrickMerge::BrickMerge(Parts parts, bool disjoint, const Cancellation& cancellation,
                       std::function<void(double, uint64_t)> progress)
    : parts_(std::move(parts)), disjoint_(disjoint), cancellation_(cancellation), progress_(std::move(progress)) {}

void BrickMerge::Rewind() {
  heads_ = {};
  read_before_ = read_;
  ++passes_;
  bricks_.assign(parts_.size(), nullptr);
  for (size_t part = 0; part < parts_.size(); ++part) {
    parts_[part]->Rewind();
    Advance(part);
  }
}

void BrickMerge::Advance(size_t part) {
  bricks_[part] = parts_[part]->Next();
  status_.Update(parts_[part]->status());
  if (!bricks_[part]) return;
  heads_.push({PlaceOf(bricks_[part]->brick_ijk), part});
  if (++read_ % kTick == 0) Tick();
}

void BrickMerge::Tick() {
  if (cancellation_.cancelled()) status_.Update(absl::CancelledError("cancelled"));
  double shares = 0;
  for (const auto& part : parts_) shares += part->share();
  progress_(static_cast<double>(passes_ - 1) + shares / static_cast<double>(parts_.size()), read_);
}

const Brick* BrickMerge::Next() {
  if (!status_.ok() || heads_.empty()) return nullptr;
  const Head first = heads_.top();
  brick_ = *bricks_[first.part];
  heads_.pop();
  Advance(first.part);
  while (!heads_.empty() && heads_.top().place == first.place) {
    const Head next = heads_.top();
    if (disjoint_) {
      status_.Update(SharedBrick(parts_[next.part]->path(), parts_[first.part]->path(), brick_.brick_ijk));
    }
    for (size_t word = 0; word < brick_.mask.size(); ++word) brick_.mask[word] |= bricks_[next.part]->mask[word];
    heads_.pop();
    Advance(next.part);
  }
  return status_.ok() ? &brick_ : nullptr;
}

}  // namespace latvox::client
