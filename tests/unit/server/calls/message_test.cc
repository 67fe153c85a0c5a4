// Messages that are too large, or cannot be read, through a real channel: what the client is told, and what is counted.
#include <gmock/gmock.h>
#include <google/protobuf/unknown_field_set.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "latvox/v1/voxelizer.grpc.pb.h"
#include "server/calls/call.h"
#include "tests/unit/server/calls.h"
#include "tests/unit/server/error_details.h"
#include "tests/unit/server/http.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;

constexpr size_t kLimit = 1 << 16;

class MessageTest : public ServerTest {
 protected:
  MessageTest() { options_.limits.max_message_bytes = kLimit; }

  grpc::Status PutPiece(const std::string& piece) {
    std::vector<v1::PutMeshRequest> messages = {PutSpec(std::string(32, 'x'), 2 * piece.size())};
    messages.emplace_back().set_mesh_piece(piece);
    v1::PutMeshResponse response;
    return PutMesh(*stub_, messages, response);
  }
};

void ExpectTooLarge(const grpc::Status& status, size_t bytes) {
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(status.error_message(), absl::StrCat("message_bytes ", bytes, " exceeds ", kLimit));
  const google::rpc::ErrorInfo info = ErrorInfoOf(status);
  EXPECT_EQ(info.reason(), "LIMIT_EXCEEDED");
  EXPECT_EQ(info.metadata().at("field"), "message_bytes");
  EXPECT_EQ(info.metadata().at("value"), absl::StrCat(bytes));
  EXPECT_EQ(info.metadata().at("limit"), absl::StrCat(kLimit));
  EXPECT_EQ(DetailsOf(status).details_size(), 1) << "to try again is of no use";
}

TEST_F(MessageTest, AsLargeAsTheLimitIsTaken) {
  Start();
  const Answer taken = Voxelize(*stub_, Spec(9), std::string(2 * kLimit, 'x'), kLimit);
  EXPECT_THAT(taken.status.error_message(), HasSubstr("not a Draco file"));
}

TEST_F(MessageTest, LargerIsRefusedByNameAndSoCounted) {
  options_.metrics_listen = "127.0.0.1:0";
  Start();
  const v1::VoxelizeRequest piece = PieceMessage(std::string(kLimit + 8, 'x'));
  VoxelizeCall call(*stub_);
  const Answer answer = call.Send(SpecMessage(Spec(9))).Send(piece).Receive();
  ExpectTooLarge(answer.status, piece.ByteSizeLong());
  EXPECT_EQ(answer.trailer("grpc-retry-pushback-ms"), "-1");
  ExpectTooLarge(PutPiece(piece.mesh_piece()), piece.ByteSizeLong());
  v1::PixelizeRequest drawing;
  for (size_t n = 0; n < kLimit / 8; ++n) drawing.add_polylines()->add_xy(0);
  v1::PixelizeResponse response;
  grpc::ClientContext context;
  ExpectTooLarge(stub_->Pixelize(&context, drawing, &response), drawing.ByteSizeLong());

  // A message that gRPC itself refuses does not count as a half-close.
  const std::string huge(options_.limits.received_message_bytes() + 1, 'x');
  VoxelizeCall other(*stub_);
  EXPECT_EQ(other.Send(SpecMessage(Spec(9))).Send(PieceMessage(huge)).Receive().status.error_code(),
            grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(PutPiece(huge).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);

  ASSERT_TRUE(Eventually([&] { return server_->calls() == 0; }));
  const std::string text = Fetch(server_->metrics_address(), "GET /metrics HTTP/1.1\r\nHost: x\r\n\r\n");
  for (const char* method : {"Voxelize", "PutMesh", "Pixelize"}) {
    EXPECT_THAT(text, HasSubstr(absl::StrCat("{code=\"RESOURCE_EXHAUSTED\",method=\"", method, "\"} 1\n")));
  }
  for (const char* method : {"Voxelize", "PutMesh"}) {
    EXPECT_THAT(text, HasSubstr(absl::StrCat("{code=\"CANCELLED\",method=\"", method, "\"} 1\n")));
  }
  EXPECT_THAT(text, HasSubstr("{reason=\"LIMIT_EXCEEDED\"} 3\n"));
}

TEST_F(MessageTest, ThatExceedsTheDeclaredLengthIsCountedByVoxelizeAndNotByPutMesh) {
  options_.metrics_listen = "127.0.0.1:0";
  Start();
  const std::string piece(1000, 'x');
  v1::VoxelizeSpec spec = Spec(9);
  spec.set_mesh_bytes(1500);
  VoxelizeCall call(*stub_);
  const Answer answer = call.Send(SpecMessage(spec)).Send(PieceMessage(piece)).Send(PieceMessage(piece)).Receive();
  std::vector<v1::PutMeshRequest> messages = {PutSpec(std::string(32, 'x'), 1500)};
  for (int n = 0; n < 2; ++n) messages.emplace_back().set_mesh_piece(piece);
  v1::PutMeshResponse response;
  for (const grpc::Status& status : {answer.status, PutMesh(*stub_, messages, response)}) {
    EXPECT_EQ(status.error_message(), "mesh_bytes 1500 was declared, but at least 2000 bytes came");
  }
  ASSERT_TRUE(Eventually([&] { return server_->calls() == 0; }));
  const std::string text = Fetch(server_->metrics_address(), "GET /metrics HTTP/1.1\r\nHost: x\r\n\r\n");
  EXPECT_THAT(text, HasSubstr("latvox_received_bytes_total{method=\"Voxelize\"} 2000\n"));
  EXPECT_THAT(text, HasSubstr("latvox_received_bytes_total{method=\"PutMesh\"} 1000\n"));
}

// Sends messages as their bytes on the wire, and no half-close; returns how the call ends.
grpc::Status SendRaw(const std::string& address, const std::string& method, const std::vector<std::string>& messages,
                     grpc_compression_algorithm compression = GRPC_COMPRESS_NONE) {
  grpc::GenericStub stub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()));
  grpc::ClientContext context;
  context.set_compression_algorithm(compression);
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
  grpc::CompletionQueue queue;
  const auto next = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  const auto call = stub.PrepareCall(&context, method, &queue);
  call->StartCall(nullptr);
  EXPECT_TRUE(next());
  for (const std::string& message : messages) {
    const grpc::Slice slice(message);
    call->Write(grpc::ByteBuffer(&slice, 1), nullptr);
    next();
  }
  grpc::Status status;
  call->Finish(&status, nullptr);
  next();
  return status;
}

// A megabyte may unpack to more than any budget.
TEST_F(MessageTest, ThatIsCompressedIsRefused) {
  options_.health_listen = "127.0.0.1:0";
  Start();
  for (const auto& [address, method] : {std::pair(server_->addresses()[0], "/latvox.v1.Voxelizer/GetLimits"),
                                        {server_->health_address(), "/grpc.health.v1.Health/Check"}}) {
    EXPECT_EQ(SendRaw(address, method, {""}, GRPC_COMPRESS_GZIP).error_code(), grpc::StatusCode::UNIMPLEMENTED);
  }
}

TEST(UnknownFields, TakeNoMemoryOnceTheyAreDropped) {
  v1::VoxelizeRequest request = PieceMessage("piece");
  const size_t before = request.SpaceUsedLong();
  auto& unknown = *request.GetReflection()->MutableUnknownFields(&request);
  for (int n = 0; n < 10000; ++n) unknown.AddLengthDelimited(99, "");
  DropUnknownFields(request);
  EXPECT_EQ(request.mesh_piece(), "piece");
  EXPECT_LT(request.SpaceUsedLong(), before + 100);
}

TEST_F(MessageTest, ThatCannotBeParsedIsNotTakenForAHalfClose) {
  Start();
  const std::string spec = SpecMessage(Spec(9)).SerializeAsString();
  const std::string whole = PieceMessage(SphereBytes()).SerializeAsString();
  for (const std::string& message : {std::string("\xff\xff"), whole.substr(0, whole.size() / 2)}) {
    const grpc::Status status = SendRaw(server_->addresses()[0], "/latvox.v1.Voxelizer/Voxelize", {spec, message});
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(status.error_message(), "a message cannot be read as latvox.v1.VoxelizeRequest");
    EXPECT_EQ(ErrorInfoOf(status).reason(), "BAD_STREAM");
  }
  const grpc::Status status = SendRaw(server_->addresses()[0], "/latvox.v1.Voxelizer/PutMesh", {"\xff\xff"});
  EXPECT_EQ(status.error_message(), "a message cannot be read as latvox.v1.PutMeshRequest");
}

}  // namespace
}  // namespace latvox
