// A voxelization that the program takes batch by batch. Client::Stream begins one:
//
//   latvox::client::BrickStream stream = client.Stream(request, std::move(drc_bytes));
//   for (const absl::StatusOr<latvox::client::BrickBatch>& batch : stream) {
//     if (!batch.ok()) return batch.status();
//     for (const latvox::client::Brick& brick : batch->bricks) Use(brick);
//   }
//   Use(stream.summary());
//
// Destroying the handle cancels the rest. A program that leaves the loop early may go on with another loop before that.
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

// The handle of one running call. It can be moved, not copied. It owns the call, the mesh's bytes and its share of the
// connections, so it may outlive its Client.
//
// Costs: one thread, which runs the call; and at most four batches in memory, including the last one from Next. A batch
// has at most 32,768 bricks of 80 bytes, and at most 3.5 MiB of fields unless those of one tile are more. The server
// waits while three batches wait. The stream copies each batch once, which costs little beside its decoding.
//
// Threads: one at a time may use a handle. CallOptions.cancellation stops the call from any other.
class LATVOX_EXPORT BrickStream {
 public:
  class Iterator;

  BrickStream(BrickStream&&) noexcept;             // the other handle may then only be destroyed or assigned to
  BrickStream& operator=(BrickStream&&) noexcept;  // ends the call of this handle first, like the destructor
  ~BrickStream();                                  // cancels the call and waits for its end, some milliseconds

  // Waits for the grid and the box of the bricks, without taking a batch. Errors: as Next.
  absl::StatusOr<Accepted> AwaitAccepted();

  // Waits for the next batch. Its memory belongs to the stream, and is valid until the next call of Next. Nothing:
  // there are no more batches, and everything that Client::Voxelize promises for an OK call holds. Errors: as
  // Client::Voxelize, after the batches that came before; later calls return the same error. CANCELLED comes at once,
  // without these batches.
  absl::StatusOr<std::optional<BrickBatch>> Next();

  // The summary of the whole, once Next has returned nothing; nullopt before that, and after an error.
  std::optional<Summary> summary() const;

  // For one loop over the rest: each step is a batch, and the last one is an error if the call ends with one. begin()
  // waits for the first batch.
  Iterator begin();
  std::default_sentinel_t end() const { return {}; }  // for every such loop

 private:
  friend class Client;
  class State;
  using Call = std::function<absl::StatusOr<Summary>(const VoxelizeHandlers&, const CallOptions&)>;

  BrickStream(Call call, const CallOptions& options);

  std::unique_ptr<State> state_;
};

// An input iterator; each step calls Next. It is valid while its stream exists, and is not moved.
class LATVOX_EXPORT BrickStream::Iterator {
 public:
  using iterator_concept = std::input_iterator_tag;  // of the standard's concepts
  using value_type = absl::StatusOr<BrickBatch>;     // a batch, or the error that ends the loop
  using difference_type = std::ptrdiff_t;            // required by the standard

  const value_type& operator*() const { return *batch_; }             // unless it is at the end
  Iterator& operator++();                                             // to the end, if it is at an error
  void operator++(int) { ++*this; }                                   // as above
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
