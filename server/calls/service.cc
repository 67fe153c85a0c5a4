#include "server/calls/service.h"

#include <memory>
#include <random>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "server/base/errors.h"
#include "server/calls/call.h"
#include "server/calls/failed_call.h"
#include "server/calls/metrics.h"
#include "server/calls/pixelize_reactor.h"
#include "server/calls/put_mesh_reactor.h"
#include "server/calls/request_log.h"
#include "server/calls/upload_mesh_reactor.h"
#include "server/calls/voxelize_reactor.h"
#include "server/calls/voxelize_small_reactor.h"
#include "server/wire/convert.h"

namespace latvox {
namespace {

constexpr char kTraceparent[] = "traceparent";

// gRPC keeps a call's only request, which is its own and not constant, until the client has taken the answer.
template <class Request>
Request& WithoutUnknownFields(const Request& request) {
  auto& own = const_cast<Request&>(request);
  DropUnknownFields(own);
  return own;
}

}  // namespace

VoxelizerService::VoxelizerService(const CallEnvironment& environment, const Authenticator& authenticator)
    : environment_(environment),
      authenticator_(authenticator),
      run_id_(absl::StrFormat("%08x", std::random_device()())) {}

CallOrigin VoxelizerService::OriginOf(const char* method, grpc::CallbackServerContext& context) {
  CallOrigin origin{.method = method,
                    .request_id = absl::StrCat(run_id_, "-", ++requests_),
                    .peer = context.peer(),
                    .caller = {},
                    .trace = {}};
  const auto [begin, end] = context.client_metadata().equal_range(kTraceparent);
  if (begin != end && std::next(begin) == end) {
    origin.trace = ReadTraceparent(absl::string_view(begin->second.data(), begin->second.size()));
  }
  if (origin.trace) context.AddInitialMetadata(kTraceparent, Traceparent(*origin.trace));
  return origin;
}

grpc::Status VoxelizerService::Admit(const grpc::CallbackServerContext& context, CallOrigin& origin) const {
  absl::StatusOr<Caller> caller = authenticator_.Authenticate(context);
  if (caller.ok()) {
    origin.caller = *std::move(caller);
    return grpc::Status::OK;
  }
  RequestRecord record;
  record.origin = origin;
  record.status = caller.status();
  LogRequest(record);
  environment_.metrics.Record(record);
  return ToGrpcStatus(caller.status());
}

template <class Call, class... Messages>
typename Call::GrpcReactor* VoxelizerService::Answer(const char* method, grpc::CallbackServerContext& context,
                                                     Messages&... messages) {
  CallOrigin origin = OriginOf(method, context);
  if (const grpc::Status status = Admit(context, origin); !status.ok()) {
    return new FailedCall<typename Call::GrpcReactor>(status);
  }
  CallEnvironment environment = environment_;
  environment.limits = LimitsOf(origin.caller, environment_.limits);
  environment.client = origin.caller.client;
  const auto call = std::make_shared<Call>(context, messages..., std::move(origin), environment);
  call->Begin();
  return call.get();
}

grpc::ServerBidiReactor<v1::VoxelizeRequest, v1::VoxelizeResponse>* VoxelizerService::Voxelize(
    grpc::CallbackServerContext* context) {
  return Answer<VoxelizeReactor>("Voxelize", *context);
}

grpc::ServerReadReactor<v1::PutMeshRequest>* VoxelizerService::PutMesh(grpc::CallbackServerContext* context,
                                                                       v1::PutMeshResponse* response) {
  return Answer<PutMeshReactor>("PutMesh", *context, *response);
}

grpc::ServerUnaryReactor* VoxelizerService::UploadMesh(grpc::CallbackServerContext* context,
                                                       const v1::UploadMeshRequest* request,
                                                       v1::UploadMeshResponse* response) {
  return Answer<UploadMeshReactor>("UploadMesh", *context, WithoutUnknownFields(*request), *response);
}

grpc::ServerWriteReactor<v1::VoxelizeResponse>* VoxelizerService::VoxelizeStored(
    grpc::CallbackServerContext* context, const v1::VoxelizeStoredRequest* request) {
  return Answer<VoxelizeStoredReactor>("VoxelizeStored", *context, WithoutUnknownFields(*request));
}

grpc::ServerUnaryReactor* VoxelizerService::VoxelizeSmall(grpc::CallbackServerContext* context,
                                                          const v1::VoxelizeSmallRequest* request,
                                                          v1::VoxelizeSmallResponse* response) {
  return Answer<VoxelizeSmallReactor>("VoxelizeSmall", *context, WithoutUnknownFields(*request), *response);
}

grpc::ServerUnaryReactor* VoxelizerService::Pixelize(grpc::CallbackServerContext* context,
                                                     const v1::PixelizeRequest* request,
                                                     v1::PixelizeResponse* response) {
  return Answer<PixelizeReactor>("Pixelize", *context, WithoutUnknownFields(*request), *response);
}

grpc::ServerUnaryReactor* VoxelizerService::GetLimits(grpc::CallbackServerContext* context,
                                                      const v1::GetLimitsRequest* request,
                                                      v1::GetLimitsResponse* response) {
  WithoutUnknownFields(*request);
  CallOrigin origin = OriginOf("GetLimits", *context);
  const grpc::Status status = Admit(*context, origin);
  if (status.ok()) {
    *response = LimitsToProto(LimitsOf(origin.caller, environment_.limits), environment_.build);
    RequestRecord record;
    record.origin = std::move(origin);
    record.bytes_out = response->ByteSizeLong();
    LogRequest(record, LogLevel::kDebug);  // such calls are frequent and cheap
    environment_.metrics.Record(record);
  }
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(status);
  return reactor;
}

}  // namespace latvox
