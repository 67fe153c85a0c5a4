#include "server/service.h"

#include <memory>
#include <random>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "server/convert.h"
#include "server/limits.h"
#include "server/pixelize_reactor.h"
#include "server/put_mesh_reactor.h"
#include "server/voxelize_reactor.h"

namespace latvox {

VoxelizerService::VoxelizerService(const CallEnvironment& environment)
    : environment_(environment), run_id_(absl::StrFormat("%08x", std::random_device()())) {}

std::string VoxelizerService::NextRequestId() { return absl::StrCat(run_id_, "-", ++requests_); }

grpc::ServerBidiReactor<v1::VoxelizeRequest, v1::VoxelizeResponse>* VoxelizerService::Voxelize(
    grpc::CallbackServerContext* context) {
  const auto reactor = std::make_shared<VoxelizeReactor>(*context, NextRequestId(), environment_);
  reactor->Begin();
  return reactor.get();
}

grpc::ServerReadReactor<v1::PutMeshRequest>* VoxelizerService::PutMesh(grpc::CallbackServerContext* context,
                                                                       v1::PutMeshResponse* response) {
  const auto reactor = std::make_shared<PutMeshReactor>(*context, *response, NextRequestId(), environment_);
  reactor->Begin();
  return reactor.get();
}

grpc::ServerUnaryReactor* VoxelizerService::Pixelize(grpc::CallbackServerContext* context,
                                                     const v1::PixelizeRequest* request,
                                                     v1::PixelizeResponse* response) {
  const auto reactor = std::make_shared<PixelizeReactor>(*context, *request, *response, NextRequestId(), environment_);
  reactor->Begin();
  return reactor.get();
}

grpc::ServerUnaryReactor* VoxelizerService::GetLimits(grpc::CallbackServerContext* context,
                                                      const v1::GetLimitsRequest* /*request*/,
                                                      v1::GetLimitsResponse* response) {
  *response = LimitsToProto(environment_.limits);
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(grpc::Status::OK);
  return reactor;
}

}  // namespace latvox
