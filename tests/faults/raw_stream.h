// A call whose messages are any bytes: what the SDK, or the generated stub, would never send.
#ifndef LATVOX_TESTS_FAULTS_RAW_STREAM_H_
#define LATVOX_TESTS_FAULTS_RAW_STREAM_H_

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/sync_stream.h>

#include <memory>
#include <string>
#include <vector>

#include "absl/time/time.h"

namespace latvox::faults {

// The messages of one call, as they go over the wire.
struct Script {
  std::string method = "/latvox.v1.Voxelizer/Voxelize";
  std::vector<std::string> messages;
  bool half_close = true;
  absl::Duration timeout = absl::Seconds(60);
};

// How a call ended.
struct Ending {
  grpc::Status status;
  size_t answers = 0;
  std::string last_answer;
  std::string pushback;  // trailer grpc-retry-pushback-ms; empty: none
};

// A channel with a connection of its own: gRPC shares one among all channels of a process to the same address.
std::shared_ptr<grpc::Channel> OwnChannel(const std::string& address);

grpc::ByteBuffer ToBuffer(const std::string& bytes);

std::unique_ptr<grpc::ClientReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>> OpenStream(grpc::Channel& channel,
                                                                                         const std::string& method,
                                                                                         grpc::ClientContext& context);

// Writes all, then reads all. Messages that the server does not want to have are dropped.
Ending Run(grpc::Channel& channel, const Script& script);

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_RAW_STREAM_H_
