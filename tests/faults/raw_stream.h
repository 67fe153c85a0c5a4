// A call whose messages are arbitrary bytes, which neither the SDK nor the generated stub would send.
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

// The end of a call.
struct Ending {
  grpc::Status status;
  size_t answers = 0;
  std::string last_answer;
  std::string pushback;  // trailer grpc-retry-pushback-ms; empty: none
};

// Makes a channel with a connection of its own, because gRPC shares one among all channels of a process to the same
// address.
std::shared_ptr<grpc::Channel> OwnChannel(const std::string& address);

grpc::ByteBuffer ToBuffer(const std::string& bytes);

std::unique_ptr<grpc::ClientReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>> OpenStream(grpc::Channel& channel,
                                                                                         const std::string& method,
                                                                                         grpc::ClientContext& context);

// Writes everything, then reads everything. Drops messages that the server does not accept.
Ending Run(grpc::Channel& channel, const Script& script);

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_RAW_STREAM_H_
