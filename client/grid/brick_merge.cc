#include "client/grid/brick_merge.h"

#include "client/grid/part_metadata.h"

namespace latvox::client {
namespace {

constexpr uint64_t kTick = 1 << 12;  // bricks, some 1 ms

}  // namespace

BrickMerge::BrickMerge(Parts parts, bool disjoint, const Cancellation& cancellation,
                       std::function<void(uint64_t)> progress)
    : parts_(std::move(parts)), disjoint_(disjoint), cancellation_(cancellation), progress_(std::move(progress)) {}

void BrickMerge::Rewind() {
  heads_ = {};
  leaves_.assign(parts_.size(), nullptr);
  for (size_t part = 0; part < parts_.size(); ++part) {
    parts_[part]->Rewind();
    Advance(part);
  }
}

void BrickMerge::Advance(size_t part) {
  leaves_[part] = parts_[part]->Next();
  if (leaves_[part]) heads_.push({PlaceOf(leaves_[part]->origin()), part});
  status_.Update(parts_[part]->status());
  if (++read_ % kTick == 0) Tick();
}

void BrickMerge::Tick() {
  if (cancellation_.cancelled()) status_.Update(absl::CancelledError("cancelled"));
  progress_(read_);
}

const Leaf* BrickMerge::Next() {
  if (!status_.ok() || heads_.empty()) return nullptr;
  const Head first = heads_.top();
  leaf_ = *leaves_[first.part];
  heads_.pop();
  Advance(first.part);
  while (!heads_.empty() && heads_.top().place == first.place) {
    const Head next = heads_.top();
    if (disjoint_) {
      status_.Update(SharedBrick(parts_[next.part]->path(), parts_[first.part]->path(), ToBrick(leaf_).brick_ijk));
    }
    AddMask(ToBrick(*leaves_[next.part]).mask, leaf_);
    heads_.pop();
    Advance(next.part);
  }
  return status_.ok() ? &leaf_ : nullptr;
}

}  // namespace latvox::client
