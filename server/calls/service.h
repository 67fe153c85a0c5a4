// latvox.v1.Voxelizer on gRPC's callback API: authenticates callers, and makes a reactor for each call.
#ifndef LATVOX_SERVER_CALLS_SERVICE_H_
#define LATVOX_SERVER_CALLS_SERVICE_H_

#include <atomic>
#include <cstdint>
#include <string>

#include "latvox/v1/voxelizer.grpc.pb.h"
#include "server/access/authenticator.h"
#include "server/access/call_origin.h"
#include "server/work/call_environment.h"

namespace latvox {

class VoxelizerService final : public v1::Voxelizer::CallbackService {
 public:
  VoxelizerService(const CallEnvironment& environment, const Authenticator& authenticator);

  grpc::ServerBidiReactor<v1::VoxelizeRequest, v1::VoxelizeResponse>* Voxelize(
      grpc::CallbackServerContext* context) override;
  grpc::ServerReadReactor<v1::PutMeshRequest>* PutMesh(grpc::CallbackServerContext* context,
                                                       v1::PutMeshResponse* response) override;
  grpc::ServerUnaryReactor* UploadMesh(grpc::CallbackServerContext* context, const v1::UploadMeshRequest* request,
                                       v1::UploadMeshResponse* response) override;
  grpc::ServerWriteReactor<v1::VoxelizeResponse>* VoxelizeStored(grpc::CallbackServerContext* context,
                                                                 const v1::VoxelizeStoredRequest* request) override;
  grpc::ServerUnaryReactor* VoxelizeSmall(grpc::CallbackServerContext* context, const v1::VoxelizeSmallRequest* request,
                                          v1::VoxelizeSmallResponse* response) override;
  grpc::ServerUnaryReactor* Pixelize(grpc::CallbackServerContext* context, const v1::PixelizeRequest* request,
                                     v1::PixelizeResponse* response) override;
  grpc::ServerUnaryReactor* GetLimits(grpc::CallbackServerContext* context, const v1::GetLimitsRequest* request,
                                      v1::GetLimitsResponse* response) override;

 private:
  // Returns the facts about a call that are known before its first message. Answers its trace context, if it has one.
  CallOrigin OriginOf(const char* method, grpc::CallbackServerContext& context);

  // Returns whether the call may go on, and then sets the caller in `origin`. Logs a refusal.
  grpc::Status Admit(const grpc::CallbackServerContext& context, CallOrigin& origin) const;

  // Answers a call with a `Call`, which is made of `messages`, or with a FailedCall.
  template <class Call, class... Messages>
  typename Call::GrpcReactor* Answer(const char* method, grpc::CallbackServerContext& context, Messages&... messages);

  const CallEnvironment environment_;
  const Authenticator& authenticator_;
  const std::string run_id_;  // random, so that request ids differ between runs and servers
  std::atomic<uint64_t> requests_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_CALLS_SERVICE_H_
