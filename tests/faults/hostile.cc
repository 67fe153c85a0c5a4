#include "tests/faults/hostile.h"

#include <algorithm>
#include <functional>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "tests/faults/mutations.h"
#include "tests/faults/raw_http2.h"

namespace latvox::faults {
namespace {

constexpr size_t kPieceBytes = size_t{256} << 10;
// The deadline of a hostile call, because some are correct requests for a huge amount of work.
constexpr absl::Duration kPatience = absl::Seconds(5);

std::string SpecMessage(const v1::VoxelizeSpec& spec) {
  v1::VoxelizeRequest request;
  *request.mutable_spec() = spec;
  return request.SerializeAsString();
}

std::string PieceMessage(const std::string& bytes) {
  v1::VoxelizeRequest request;
  request.set_mesh_piece(bytes);
  return request.SerializeAsString();
}

Script Request(const v1::VoxelizeSpec& spec, const std::string& drc) {
  Script script;
  script.messages.push_back(SpecMessage(spec));
  for (size_t begin = 0; begin < drc.size(); begin += kPieceBytes) {
    script.messages.push_back(PieceMessage(drc.substr(begin, kPieceBytes)));
  }
  return script;
}

Script MutatedMesh(const Job& job, Chance& chance) {
  const std::string drc = MutatedBytes(job.drc, chance);
  v1::VoxelizeSpec spec = SpecOf(job);
  spec.set_mesh_bytes(drc.size());
  return Request(spec, drc);
}

Script HugeCounts(const Job& job, Chance& chance) {
  const size_t sizes[] = {61, 224, 4000, 1 << 20};
  const std::string drc = DracoWithHugeCounts(chance.OneIn(2), chance.Of(sizes), chance);
  v1::VoxelizeSpec spec = SpecOf(job);
  spec.set_mesh_bytes(0);
  return Request(spec, drc);
}

Script LyingLength(const Job& job, Chance& chance) {
  v1::VoxelizeSpec spec = SpecOf(job);
  const uint64_t lies[] = {1, job.drc.size() - 1, job.drc.size() + 1, uint64_t{1} << 40, ~uint64_t{0}};
  spec.set_mesh_bytes(chance.Of(lies));
  return Request(spec, job.drc);
}

Script BadOrder(const Job& job, Chance& chance) {
  Script script = Request(SpecOf(job), job.drc);
  switch (chance.Below(4)) {
    case 0:
      std::swap(script.messages[0], script.messages[1]);
      break;
    case 1:
      script.messages.push_back(script.messages[0]);
      break;
    case 2:
      script.messages.insert(script.messages.begin() + 1, std::string());
      break;
    default:
      script.messages.clear();
      break;
  }
  return script;
}

Script AbsurdSpec(const Job& job, Chance& chance) {
  v1::VoxelizeSpec spec = SpecOf(job);
  using Double = std::numeric_limits<double>;
  switch (chance.Below(7)) {
    case 0:
      spec.set_voxel_size(chance.OneIn(2) ? Double::denorm_min() : Double::quiet_NaN());
      break;
    case 1:
      spec.set_voxel_size(1e-6);  // billions of voxels
      break;
    case 2:
      spec.mutable_origin()->set_x(chance.OneIn(2) ? 1e308 : Double::infinity());
      break;
    case 3:
      spec.mutable_lattice()->mutable_basis()->mutable_a()->set_x(1);
      break;
    case 4:
      spec.set_separability(~0U);
      break;
    case 5:
      spec.mutable_region()->mutable_min()->set_i(std::numeric_limits<int32_t>::min());
      spec.mutable_region()->mutable_max()->set_i(std::numeric_limits<int32_t>::max());
      break;
    default:
      spec.set_resolution(65536);
      spec.set_verify(true);
      break;
  }
  Script script = Request(spec, job.drc);
  script.timeout = absl::Seconds(2);
  return script;
}

Script NoMessage(const Job&, Chance& chance) {
  const size_t sizes[] = {1, 100, 100'000, size_t{5} << 20};  // the last is over the limit of one message
  return {.messages = {chance.Bytes(chance.Of(sizes))}};
}

Script NoEnd(const Job& job, Chance& chance) {
  Script script = Request(SpecOf(job), job.drc);
  script.messages.resize(chance.Below(script.messages.size() + 1));
  script.half_close = false;
  script.timeout = absl::Seconds(2);
  return script;
}

Script NoSuchMethod(const Job& job, Chance& chance) {
  Script script = Request(SpecOf(job), job.drc);
  script.method = chance.OneIn(2) ? "/latvox.v1.Voxelizer/Nothing" : "/" + std::string(1000, 'x');
  return script;
}

// Floods that HTTP/2 allows: opened and reset streams, pings, settings, endless headers.
std::string Flood(const Job& job, Chance& chance) {
  std::string bytes = Preface();
  const uint64_t kind = chance.Below(5);
  for (uint32_t n = 0; n < 300; ++n) {
    const uint32_t stream = 2 * n + 1;
    if (kind == 0)
      absl::StrAppend(&bytes, CallHeaders(stream, "/latvox.v1.Voxelizer/Voxelize"),
                      MessageFrame(stream, SpecMessage(SpecOf(job)), false),
                      Frame(kResetStream, 0, stream, std::string(4, '\0')));
    if (kind == 1) bytes += Frame(kPing, 0, 0, std::string(8, 'p'));
    if (kind == 2) bytes += Frame(kSettings, 0, 0, std::string("\0\4\0\0\xff\xff", 6));
    if (kind == 3) bytes += Frame(n == 0 ? kHeaders : kContinuation, 0, 1, Header("x", std::string(100, 'y')));
    if (kind == 4) bytes += Frame(kData, 0, stream, std::string(100, 'd'));
  }
  return bytes;
}

std::string RawBytes(const Job& job, Chance& chance) {
  const std::string call = CallHeaders(1, "/latvox.v1.Voxelizer/Voxelize");
  switch (chance.Below(5)) {
    case 0:
      return chance.Bytes(1 + chance.Below(2000));
    case 1:
      return Preface() + chance.Bytes(1 + chance.Below(2000));
    case 2:
      return "GET / HTTP/1.1\r\nHost: latvox\r\n\r\n";
    case 3:  // a message that claims 4 GiB
      return absl::StrCat(Preface(), call, Frame(kData, 0, 1, std::string("\0\xff\xff\xff\xff", 5) + "begin"));
    default:
      return Flood(job, chance);
  }
}

void SendRawBytes(const std::string& address, const Job& job, Chance& chance, Record& record) {
  RawConnection connection(address);
  connection.Send(RawBytes(job, chance));
  const bool closed = connection.WaitUntilClosed(absl::Seconds(chance.Between(0, 2)));
  if (chance.OneIn(2)) connection.Reset();
  record.detail = closed ? "the server closed the connection" : "the server kept the connection";
  record.outcome = "rejected";
}

}  // namespace

bool IsFairAnswer(const grpc::Status& status) {
  return status.error_code() != grpc::StatusCode::INTERNAL && status.error_code() != grpc::StatusCode::UNKNOWN &&
         status.error_code() != grpc::StatusCode::UNAVAILABLE && status.error_code() != grpc::StatusCode::DATA_LOSS;
}

void BeHostile(const std::string& address, grpc::Channel& channel, const Job& job, Chance& chance, Record& record) {
  static const std::pair<const char*, std::function<Script(const Job&, Chance&)>> kinds[] = {
      {"mutated mesh", MutatedMesh},
      {"huge counts", HugeCounts},
      {"lying length", LyingLength},
      {"bad order", BadOrder},
      {"absurd spec", AbsurdSpec},
      {"no message", NoMessage},
      {"no end", NoEnd},
      {"no such method", NoSuchMethod},
  };
  const uint64_t kind = chance.Below(std::size(kinds) + 2);
  if (kind >= std::size(kinds)) {
    record.job = "raw bytes";
    return SendRawBytes(address, job, chance, record);
  }
  record.job = kinds[kind].first;
  Script script = kinds[kind].second(job, chance);
  script.timeout = std::min(script.timeout, kPatience);
  const Ending ending = Run(channel, script);
  record.outcome = IsFairAnswer(ending.status) ? "rejected" : "wrong";
  record.detail = absl::StrCat(ending.status.error_code(), " ", ending.status.error_message());
}

}  // namespace latvox::faults
