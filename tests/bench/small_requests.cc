// Calls a server with small requests, for tests/bench/small. Each client has a connection of its own, and sends its
// next request when the answer is there. The server keeps the mesh.
//   latvox_bench_small call unix:/tmp/socket --clients 8 --seconds 5 --save answer   # prints JSON
//   latvox_bench_small echo unix:/tmp/other answer                                   # until its standard input ends
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "latvox/v1/voxelizer.grpc.pb.h"
#include "server/decode/mesh_store.h"
#include "tests/bench/meshes.h"

namespace latvox {
namespace {

using Clock = std::chrono::steady_clock;

struct Options {
  std::string address, answer, mesh = "sphere:1000";
  uint32_t resolution = 64;
  int clients = 1;
  double seconds = 3;
  bool stream = false;
};

void AppendBytes(const auto& values, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(values[0]));
}

// A connection, and the request that it repeats.
class Caller {
 public:
  Caller(const Options& options, const TriangleMesh& mesh) : stream_(options.stream) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    stub_ = v1::Voxelizer::NewStub(
        grpc::CreateCustomChannel(options.address, grpc::InsecureChannelCredentials(), arguments));
    AppendBytes(mesh.vertices, mesh_);
    AppendBytes(mesh.triangles, mesh_);
    v1::VoxelizeSpec& spec = *request_.mutable_spec();
    spec.mutable_lattice()->set_named(v1::NAMED_LATTICE_CARTESIAN);
    spec.set_resolution(options.resolution);
    spec.set_mesh_bytes(mesh_.size());
    const MeshDigest digest = DigestOf(absl::Cord(mesh_));
    spec.set_mesh_sha256(digest.data(), digest.size());
    v1::RawMesh& raw = *spec.mutable_raw_mesh();
    raw.set_vertices(mesh.vertices.size());
    raw.set_triangles(mesh.triangles.size());
    raw.set_positions(v1::POSITION_TYPE_FLOAT32);
  }

  // Stores the mesh, and leaves the answer.
  grpc::Status Store(v1::VoxelizeSmallResponse& answer) const {
    v1::UploadMeshRequest upload;
    v1::UploadMeshResponse stored;
    upload.mutable_spec()->set_mesh_sha256(request_.spec().mesh_sha256());
    upload.mutable_spec()->set_mesh_bytes(mesh_.size());
    upload.set_mesh_piece(mesh_);
    grpc::ClientContext context;
    const grpc::Status status = stub_->UploadMesh(&context, upload, &stored);
    return status.ok() ? CallSmall(answer) : status;
  }

  grpc::Status Call() const {
    if (stream_) return CallStream();
    v1::VoxelizeSmallResponse answer;
    return CallSmall(answer);
  }

 private:
  grpc::Status CallSmall(v1::VoxelizeSmallResponse& answer) const {
    grpc::ClientContext context;
    return stub_->VoxelizeSmall(&context, request_, &answer);
  }

  grpc::Status CallStream() const {
    grpc::ClientContext context;
    const auto call = stub_->Voxelize(&context);
    v1::VoxelizeRequest request;
    *request.mutable_spec() = request_.spec();
    call->WriteLast(request, {});
    v1::VoxelizeResponse answer;
    while (call->Read(&answer)) continue;
    return call->Finish();
  }

  const bool stream_;
  std::string mesh_;
  v1::VoxelizeSmallRequest request_;  // names the mesh
  std::unique_ptr<v1::Voxelizer::Stub> stub_;
};

struct Calls {
  std::vector<double> ms;
  grpc::Status status;
};

Calls CallUntil(const Caller& caller, Clock::time_point end) {
  Calls calls;
  Clock::time_point now = Clock::now();
  while (calls.status.ok() && now < end) {
    const auto began = Clock::now();
    calls.status = caller.Call();
    now = Clock::now();
    calls.ms.push_back(std::chrono::duration<double, std::milli>(now - began).count());
  }
  return calls;
}

int Fail(absl::string_view what) {
  std::fputs(absl::StrCat("latvox_bench_small: ", what, "\n").c_str(), stderr);
  return 2;
}

int CallServer(const Options& options) {
  const auto mesh = MeshNamed(options.mesh);
  if (!mesh.ok()) return Fail(mesh.status().message());
  std::vector<std::unique_ptr<Caller>> callers;
  for (int n = 0; n < options.clients; ++n) callers.push_back(std::make_unique<Caller>(options, *mesh));
  if (!options.answer.empty()) {
    v1::VoxelizeSmallResponse answer;
    const grpc::Status status = callers.front()->Store(answer);
    if (!status.ok()) return Fail(status.error_message());
    std::ofstream file(options.answer, std::ios::binary);
    if (!answer.SerializeToOstream(&file) || !file.flush())
      return Fail(absl::StrCat(options.answer, ": cannot be written"));
  }
  for (const auto& caller : callers) {  // connects
    if (const grpc::Status status = caller->Call(); !status.ok()) return Fail(status.error_message());
  }
  const Clock::time_point began = Clock::now();
  const auto end = began + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.seconds));
  std::vector<Calls> results(callers.size());
  std::vector<std::thread> threads;
  for (size_t n = 0; n < callers.size(); ++n) {
    threads.emplace_back([&, n] { results[n] = CallUntil(*callers[n], end); });
  }
  for (std::thread& thread : threads) thread.join();
  const double seconds = std::chrono::duration<double>(Clock::now() - began).count();
  std::vector<double> ms;
  for (const Calls& calls : results) {
    if (!calls.status.ok()) return Fail(calls.status.error_message());
    ms.insert(ms.end(), calls.ms.begin(), calls.ms.end());
  }
  if (ms.empty()) return Fail("no call was made in that time");
  std::sort(ms.begin(), ms.end());
  const nlohmann::json json{{"calls", ms.size()},
                            {"calls_per_second", static_cast<double>(ms.size()) / seconds},
                            {"ms_median", ms[ms.size() / 2]},
                            {"ms_p99", ms[ms.size() * 99 / 100]}};
  return std::puts(json.dump().c_str()) < 0 ? 2 : 0;
}

// Answers each VoxelizeSmall with the same message.
class Echo final : public v1::Voxelizer::CallbackService {
 public:
  explicit Echo(const v1::VoxelizeSmallResponse& answer) : answer_(answer) {}

 private:
  grpc::ServerUnaryReactor* VoxelizeSmall(grpc::CallbackServerContext* context, const v1::VoxelizeSmallRequest*,
                                          v1::VoxelizeSmallResponse* response) override {
    *response = answer_;
    grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
    reactor->Finish(grpc::Status::OK);
    return reactor;
  }

  const v1::VoxelizeSmallResponse& answer_;
};

int ServeEcho(const Options& options) {
  v1::VoxelizeSmallResponse answer;
  std::ifstream file(options.answer, std::ios::binary);
  if (!answer.ParseFromIstream(&file)) return Fail(absl::StrCat(options.answer, ": cannot be read"));
  Echo echo(answer);
  grpc::ServerBuilder builder;
  builder.AddListeningPort(options.address, grpc::InsecureServerCredentials());
  builder.RegisterService(&echo);
  const std::unique_ptr<grpc::Server> server = builder.BuildAndStart();
  if (!server) return Fail(absl::StrCat(options.address, ": cannot listen"));
  std::puts("ready");
  std::fflush(stdout);
  while (std::getchar() != EOF) continue;
  server->Shutdown();
  return 0;
}

int Main(int argc, char** argv) {
  Options options;
  CLI::App program("Small requests to a server");
  program.require_subcommand(1);
  CLI::App& call = *program.add_subcommand("call", "Calls a server again and again");
  call.add_option("address", options.address)->required();
  call.add_option("--mesh", options.mesh, "as for latvox_bench");
  call.add_option("--resolution", options.resolution);
  call.add_option("--clients", options.clients)->check(CLI::Range(1, 1000));
  call.add_option("--seconds", options.seconds)->check(CLI::PositiveNumber);
  call.add_option("--save", options.answer, "stores the mesh first, and the answer in this file");
  call.add_flag("--stream", options.stream, "calls Voxelize; default: VoxelizeSmall");
  CLI::App& echo = *program.add_subcommand("echo", "Serves one answer, until standard input ends");
  echo.add_option("address", options.address)->required();
  echo.add_option("answer", options.answer)->required();
  CLI11_PARSE(program, argc, argv);
  return echo.parsed() ? ServeEcho(options) : CallServer(options);
}

}  // namespace
}  // namespace latvox

int main(int argc, char** argv) { return latvox::Main(argc, argv); }
