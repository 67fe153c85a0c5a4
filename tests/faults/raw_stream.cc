#include "tests/faults/raw_stream.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/impl/rpc_method.h>
#include <grpcpp/security/credentials.h>

namespace latvox::faults {

std::shared_ptr<grpc::Channel> OwnChannel(const std::string& address) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_ENABLE_RETRIES, 0);
  arguments.SetMaxReceiveMessageSize(64 << 20);
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

grpc::ByteBuffer ToBuffer(const std::string& bytes) {
  const grpc::Slice slice(bytes);
  return {&slice, 1};
}

// As in generated stubs, but messages are bytes. Without this header the generic stub offers only completion queues and
// callbacks.
std::unique_ptr<grpc::ClientReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>> OpenStream(grpc::Channel& channel,
                                                                                         const std::string& method,
                                                                                         grpc::ClientContext& context) {
  const grpc::internal::RpcMethod rpc(method.c_str(), grpc::internal::RpcMethod::BIDI_STREAMING);
  return std::unique_ptr<grpc::ClientReaderWriter<grpc::ByteBuffer, grpc::ByteBuffer>>(
      grpc::internal::ClientReaderWriterFactory<grpc::ByteBuffer, grpc::ByteBuffer>::Create(&channel, rpc, &context));
}

Ending Run(grpc::Channel& channel, const Script& script) {
  grpc::ClientContext context;
  context.set_deadline(absl::ToChronoTime(absl::Now() + script.timeout));
  const auto stream = OpenStream(channel, script.method, context);
  bool open = true;
  for (const std::string& message : script.messages) open = open && stream->Write(ToBuffer(message));
  if (open && script.half_close) stream->WritesDone();
  Ending ending;
  for (grpc::ByteBuffer answer; stream->Read(&answer);) {
    grpc::Slice slice;
    if (answer.DumpToSingleSlice(&slice).ok()) {
      ending.last_answer.assign(reinterpret_cast<const char*>(slice.begin()), slice.size());
    }
    ++ending.answers;
  }
  ending.status = stream->Finish();
  const auto& trailers = context.GetServerTrailingMetadata();
  if (const auto pushback = trailers.find("grpc-retry-pushback-ms"); pushback != trailers.end()) {
    ending.pushback.assign(pushback->second.data(), pushback->second.size());
  }
  return ending;
}

}  // namespace latvox::faults
