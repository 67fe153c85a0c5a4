#include "latvox/brick_stream.h"

#include <array>
#include <condition_variable>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "latvox/cancellation.h"
#include "latvox/export.h"

namespace latvox::client {

// The call runs on `thread_`, like a call with handlers, and puts its batches into a ring, where Next finds them.
class LATVOX_HIDDEN BrickStream::State {
 public:
  State(Call call, const CallOptions& options);
  ~State();

  absl::StatusOr<Accepted> AwaitAccepted();
  absl::StatusOr<std::optional<BrickBatch>> Next();
  std::optional<Summary> summary() const;

 private:
  static constexpr size_t kReadAhead = 3;  // batches that wait, at most

  struct Batch {
    std::vector<Brick> bricks;  // kept from turn to turn, to reuse its memory
    double progress = 0;
    std::vector<FieldValues> fields;  // kept in the same way
  };

  void Run(const Call& call, CallOptions options);
  absl::Status Offer(const BrickBatch& batch);
  void Stop();
  bool AllTaken() const { return taken_ == offered_; }

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // Batch n is in place n modulo size. There is one place more than waiting batches, for the caller's batch taken_ - 1.
  std::array<Batch, kReadAhead + 1> ring_;
  // Guarded by mutex_:
  size_t offered_ = 0, taken_ = 0;
  bool stopped_ = false;
  std::optional<Accepted> accepted_;
  std::optional<absl::StatusOr<Summary>> end_;

  // A cancellation of its own: the caller's may belong to other calls, too.
  const Cancellation stop_;
  const Cancellation::Subscription on_stop_, on_cancel_;  // they run at once if it is cancelled already

  std::thread thread_;
};

BrickStream::State::State(Call call, const CallOptions& options)
    : on_stop_(stop_, [this] { Stop(); }), on_cancel_(options.cancellation, [this] { stop_.Cancel(); }) {
  try {
    thread_ = std::thread([this, call = std::move(call), options] { Run(call, options); });
  } catch (const std::system_error& error) {
    end_ = absl::ResourceExhaustedError(absl::StrCat("no thread for a BrickStream: ", error.what()));
  }
}

BrickStream::State::~State() {
  stop_.Cancel();
  if (thread_.joinable()) thread_.join();
}

void BrickStream::State::Stop() {
  const std::lock_guard lock(mutex_);
  stopped_ = true;
  changed_.notify_all();
}

void BrickStream::State::Run(const Call& call, CallOptions options) {
  options.cancellation = stop_;
  const auto accept = [this](const Accepted& accepted) {
    const std::lock_guard lock(mutex_);
    accepted_ = accepted;
    changed_.notify_all();
    return absl::OkStatus();
  };
  const auto offer = [this](const BrickBatch& batch) { return Offer(batch); };
  absl::StatusOr<Summary> end = absl::ResourceExhaustedError("memory: there is none left for a BrickStream");
  try {
    end = call({.on_accepted = accept, .on_bricks = offer}, options);
  } catch (const std::bad_alloc&) {
  }
  const std::lock_guard lock(mutex_);
  end_ = std::move(end);
  changed_.notify_all();
}

absl::Status BrickStream::State::Offer(const BrickBatch& batch) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return stopped_ || offered_ - taken_ < kReadAhead; });
    if (stopped_) return absl::CancelledError("cancelled by the caller");
  }
  // No other thread looks at this place, or writes offered_.
  Batch& place = ring_[offered_ % ring_.size()];
  const auto& [bricks, progress, fields] = batch;  // all members of a batch
  place.bricks.assign(bricks.begin(), bricks.end());
  place.progress = progress;
  place.fields.assign(fields.begin(), fields.end());
  const std::lock_guard lock(mutex_);
  ++offered_;
  changed_.notify_all();
  return absl::OkStatus();
}

absl::StatusOr<Accepted> BrickStream::State::AwaitAccepted() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return accepted_ || end_ || stopped_; });
  if (accepted_) return *accepted_;
  if (!end_) return absl::CancelledError("cancelled by the caller");
  return end_->ok() ? absl::InternalError("the call ended without Accepted") : end_->status();
}

absl::StatusOr<std::optional<BrickBatch>> BrickStream::State::Next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !AllTaken() || end_ || stopped_; });
  if (end_ && AllTaken()) {
    if (!end_->ok()) return end_->status();
    return std::nullopt;
  }
  if (stopped_) return absl::CancelledError("cancelled by the caller");
  const Batch& batch = ring_[taken_ % ring_.size()];
  ++taken_;
  changed_.notify_all();
  return BrickBatch{batch.bricks, batch.progress, batch.fields};
}

std::optional<Summary> BrickStream::State::summary() const {
  const std::lock_guard lock(mutex_);
  return end_ && end_->ok() && AllTaken() ? std::optional(**end_) : std::nullopt;
}

BrickStream::BrickStream(Call call, const CallOptions& options)
    : state_(std::make_unique<State>(std::move(call), options)) {}
BrickStream::BrickStream(BrickStream&&) noexcept = default;
BrickStream& BrickStream::operator=(BrickStream&&) noexcept = default;
BrickStream::~BrickStream() = default;

absl::StatusOr<Accepted> BrickStream::AwaitAccepted() { return state_->AwaitAccepted(); }
absl::StatusOr<std::optional<BrickBatch>> BrickStream::Next() { return state_->Next(); }
std::optional<Summary> BrickStream::summary() const { return state_->summary(); }
BrickStream::Iterator BrickStream::begin() { return Iterator(*this); }

BrickStream::Iterator& BrickStream::Iterator::operator++() {
  if (batch_->ok()) {
    Advance();
  } else {
    batch_.reset();
  }
  return *this;
}

void BrickStream::Iterator::Advance() {
  const absl::StatusOr<std::optional<BrickBatch>> next = stream_->Next();
  if (!next.ok()) {
    batch_ = next.status();
  } else if (*next) {
    batch_ = **next;
  } else {
    batch_.reset();
  }
}

}  // namespace latvox::client
