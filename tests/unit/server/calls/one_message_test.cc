// Calls with one message from the client, through a real channel: many at a time, early ends, access, memory.
#include <gmock/gmock.h>

#include <atomic>
#include <thread>
#include <vector>

#include "core/voxelizer/digest.h"
#include "tests/unit/server/calls.h"
#include "tests/unit/server/error_details.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;

v1::UploadMeshRequest Piece(const std::string& mesh, uint64_t offset, size_t bytes) {
  v1::UploadMeshRequest request;
  request.mutable_spec()->set_mesh_sha256(Sha256(mesh));
  request.mutable_spec()->set_mesh_bytes(mesh.size());
  request.set_offset(offset);
  request.set_mesh_piece(mesh.substr(offset, bytes));
  return request;
}

v1::VoxelizeSpec SpecOfStored(uint32_t resolution) {
  v1::VoxelizeSpec spec = Spec(resolution);
  spec.set_mesh_sha256(Sha256(SphereBytes()));
  return spec;
}

class OneMessageTest : public ServerTest {
 protected:
  grpc::Status Upload(const v1::UploadMeshRequest& request, v1::UploadMeshResponse& response) {
    grpc::ClientContext context;
    return stub_->UploadMesh(&context, request, &response);
  }

  void UploadAll() {
    v1::UploadMeshResponse response;
    do {
      const auto request = Piece(SphereBytes(), response.next_offset(), 5000);
      const grpc::Status status = Upload(request, response);
      ASSERT_TRUE(status.ok()) << status.error_message();
    } while (!response.stored());
  }

  grpc::Status Small(const v1::VoxelizeSpec& spec, const std::string& mesh, v1::VoxelizeSmallResponse& response) {
    grpc::ClientContext context;
    v1::VoxelizeSmallRequest request;
    *request.mutable_spec() = spec;
    request.set_mesh(mesh);
    return stub_->VoxelizeSmall(&context, request, &response);
  }
};

TEST_F(OneMessageTest, ManyCallersUploadOneMeshTogether) {
  Start();
  std::atomic<int> stored = 0;
  std::vector<std::thread> callers;
  for (int n = 0; n < 8; ++n) {
    callers.emplace_back([&, n] {
      v1::UploadMeshResponse response;
      while (!response.stored()) {
        const auto request = Piece(SphereBytes(), response.next_offset(), 500 + 100 * static_cast<size_t>(n));
        const grpc::Status status = Upload(request, response);
        // Another caller may have finished the upload, and its mesh is stored in a moment.
        if (!status.ok() && ErrorInfoOf(status).reason() != "WRONG_OFFSET") return;
        if (!status.ok()) response.Clear();
      }
      ++stored;
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(stored, 8);
  EXPECT_TRUE(Eventually([&] { return server_->calls() == 0 && server_->reserved_memory() == 0; }));
  EXPECT_TRUE(Voxelize(*stub_, SpecOfStored(20), "").status.ok());
}

TEST_F(OneMessageTest, AnUnfinishedUploadKeepsMemoryAndNoCall) {
  Start();
  v1::UploadMeshResponse response;
  ASSERT_TRUE(Upload(Piece(SphereBytes(), 0, 700), response).ok());
  EXPECT_TRUE(Eventually([&] { return server_->calls() == 0; }));
  EXPECT_EQ(server_->reserved_memory(), 700);
}

TEST_F(OneMessageTest, ASmallAnswerIsThatOfTheStream) {
  Start();
  UploadAll();
  const Answer stream = Voxelize(*stub_, Spec(40), SphereBytes());
  ASSERT_TRUE(stream.status.ok());
  for (const std::string& mesh : {SphereBytes(), std::string()}) {
    v1::VoxelizeSmallResponse small;
    const grpc::Status status = Small(mesh.empty() ? SpecOfStored(40) : Spec(40), mesh, small);
    ASSERT_TRUE(status.ok()) << status.error_message();
    EXPECT_EQ(small.summary().certificate().digest(), stream.summary().certificate().digest());
    EXPECT_EQ(small.accepted().index_box().SerializeAsString(), stream.accepted().index_box().SerializeAsString());
    int bricks = 0;
    for (const v1::BrickBatch& batch : small.bricks()) bricks += batch.brick_ijk_size() / 3;
    EXPECT_EQ(static_cast<size_t>(bricks), stream.Bricks().size());
  }
  EXPECT_TRUE(Eventually([&] { return server_->calls() == 0 && server_->reserved_memory() == 0; }));
}

TEST_F(OneMessageTest, AnAnswerBeyondTheLimitEndsTheWork) {
  Start();
  v1::VoxelizeSpec spec = Spec(3000);
  spec.set_minimal(false);
  v1::VoxelizeSmallResponse response;
  const grpc::Status status = Small(spec, SphereBytes(), response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), HasSubstr("exceeds 4194304; UploadMesh and VoxelizeStored have no such limit"));
  const google::rpc::ErrorInfo info = ErrorInfoOf(status);
  EXPECT_EQ(info.reason(), "LIMIT_EXCEEDED");
  EXPECT_EQ(info.metadata().at("field"), "answer_bytes");
  EXPECT_EQ(info.metadata().at("limit_name"), "max_message_bytes");
  EXPECT_TRUE(Eventually([&] { return server_->calls() == 0 && server_->reserved_memory() == 0; }));
}

TEST_F(OneMessageTest, ClientsThatLeaveFreeEverything) {
  Start();
  UploadAll();
  v1::VoxelizeSpec spec = SpecOfStored(3000);
  spec.set_minimal(false);
  {
    grpc::ClientContext context;
    v1::VoxelizeStoredRequest request;
    *request.mutable_spec() = spec;
    const auto stream = stub_->VoxelizeStored(&context, request);
    v1::VoxelizeResponse message;
    ASSERT_TRUE(stream->Read(&message) && message.has_accepted());
    context.TryCancel();
    EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::CANCELLED);
  }
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(20));
  v1::VoxelizeSmallRequest request;
  *request.mutable_spec() = spec;
  request.mutable_spec()->set_verify(true);
  request.mutable_spec()->set_resolution(2000);
  v1::VoxelizeSmallResponse response;
  const grpc::Status late = stub_->VoxelizeSmall(&context, request, &response);
  EXPECT_FALSE(late.ok());
  EXPECT_TRUE(Eventually([&] { return server_->calls() == 0 && server_->reserved_memory() == 0; }));
}

TEST_F(OneMessageTest, CountAsJobsOfTheirClient) {
  options_.limits.max_jobs_per_client = 1;
  StartPatient();
  UploadAll();
  VoxelizeCall busy(*stub_);
  StartBigJob(busy);
  v1::VoxelizeSmallResponse small;
  v1::UploadMeshResponse response;
  for (const grpc::Status& status :
       {Small(SpecOfStored(20), "", small), Upload(Piece(SphereBytes(), 0, 9), response)}) {
    EXPECT_EQ(ErrorInfoOf(status).reason(), "TOO_MANY_JOBS_OF_CLIENT");
  }
  busy.context().TryCancel();
}

}  // namespace
}  // namespace latvox
