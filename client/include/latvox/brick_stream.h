// A voxelization that is taken batch by batch. Client::Stream begins one:
//
//   latvox::client::BrickStream stream = client.Stream(request, std::move(drc_bytes));
//   for (const absl::StatusOr<latvox::client::BrickBatch>& batch : stream) {
//     if (!batch.ok()) return batch.status();
//     for (const latvox::client::Brick& brick : batch->bricks) Use(brick);
//   }
//   Use(stream.summary());
//
// Leaving the loop early, or any other way in which the handle goes, cancels what is left.
#ifndef LATVOX_LATVOX_BRICK_STREAM_H_
#define LATVOX_LATVOX_BRICK_STREAM_H_

#include <cstddef>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>

#include "absl/status/statusor.h"
#include "latvox/call_options.h"
#include "latvox/export.h"
#include "latvox/types.h"
#include "latvox/voxelize_handlers.h"

namespace latvox::client {

// The handle of one running call: it can be moved, not copied, and owns the call, the mesh's bytes and its share of the
// connections, so that it may outlive its Client.
//
// Costs: one thread, which runs the call; and at most four batches in memory, that of the last Next among them, each of
// 32,768 bricks of 80 bytes at most, with distances of up to 2 MiB, or attributes of up to 3.5. While the others wait
// to be taken, the server is held back. A batch is copied once, which is little beside unpacking it.
//
// Threads: one at a time may use a handle. CallOptions.cancellation stops it from any other.
class LATVOX_EXPORT BrickStream {
 public:
  class Iterator;

  BrickStream(BrickStream&&) noexcept;             // the other one may then be destroyed or assigned to, no more
  BrickStream& operator=(BrickStream&&) noexcept;  // as if the one before were destroyed
  ~BrickStream();                                  // cancels the call and waits for its end, some milliseconds

  // Waits for the grid and the box that the bricks lie in, without taking any. Errors: as Next.
  absl::StatusOr<Accepted> AwaitAccepted();

  // Waits for the next batch. Its memory is the stream's, and gone at the next Next. Nothing: there is none any more,
  // and all that Client::Voxelize promises of a call that is OK holds. Errors: as Client::Voxelize; after those batches
  // that came before it, and for good. CANCELLED at once, without them.
  absl::StatusOr<std::optional<BrickBatch>> Next();

  // Of the whole, once Next has returned nothing; before, and after an error, there is none.
  std::optional<Summary> summary() const;

  // For one loop over what is left: a batch each, and an error if it ends with one. begin() waits for the first batch.
  Iterator begin();
  std::default_sentinel_t end() const { return {}; }  // of any such loop

 private:
  friend class Client;
  class State;
  using Call = std::function<absl::StatusOr<Summary>(const VoxelizeHandlers&, const CallOptions&)>;

  BrickStream(Call call, const CallOptions& options);

  std::unique_ptr<State> state_;
};

// An input iterator; each step is a Next. Valid while its stream is, and is not moved.
class LATVOX_EXPORT BrickStream::Iterator {
 public:
  using iterator_concept = std::input_iterator_tag;  // of the standard's concepts
  using value_type = absl::StatusOr<BrickBatch>;     // a batch, or the error that ends the loop
  using difference_type = std::ptrdiff_t;            // which the standard wants to be there

  const value_type& operator*() const { return *batch_; }             // unless it is at the end
  Iterator& operator++();                                             // to the end, if it is at an error
  void operator++(int) { ++*this; }                                   // likewise
  bool operator==(std::default_sentinel_t) const { return !batch_; }  // whether it is at the end

 private:
  friend class BrickStream;
  explicit Iterator(BrickStream& stream) : stream_(&stream) { Advance(); }
  void Advance();

  BrickStream* stream_;
  std::optional<value_type> batch_;
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_BRICK_STREAM_H_
