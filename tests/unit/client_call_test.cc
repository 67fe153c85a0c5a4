// The SDK against servers that answer what they like.
#include <gmock/gmock.h>
#include <grpcpp/ext/health_check_service_server_builder_option.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <thread>

#include "client/client.h"
#include "client/digest.h"
#include "client/error.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "latvox/v1/voxelizer.grpc.pb.h"

namespace latvox::client {
namespace {

using testing::HasSubstr;

using Stream = grpc::ServerReaderWriter<v1::VoxelizeResponse, v1::VoxelizeRequest>;
using Behaviour = std::function<grpc::Status(grpc::ServerContext*, Stream*)>;

class FakeService final : public v1::Voxelizer::Service {
 public:
  explicit FakeService(Behaviour behaviour) : behaviour_(std::move(behaviour)) {}
  grpc::Status Voxelize(grpc::ServerContext* context, Stream* stream) override { return behaviour_(context, stream); }
  grpc::Status GetLimits(grpc::ServerContext*, const v1::GetLimitsRequest*, v1::GetLimitsResponse* response) override {
    response->set_max_extent(65536);
    response->set_version("fake");
    return grpc::Status::OK;
  }

 private:
  Behaviour behaviour_;
};

// A server in this process, with a client connected to it.
class Fake {
 public:
  explicit Fake(Behaviour behaviour) : service_(std::move(behaviour)) {
    grpc::EnableDefaultHealthCheckService(true);
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(&service_);
    builder.SetMaxReceiveMessageSize(2 << 20);
    server_ = builder.BuildAndStart();
    auto client = Client::Connect(address());
    EXPECT_TRUE(client.ok()) << client.status();
    client_.emplace(*std::move(client));
  }
  ~Fake() { server_->Shutdown(std::chrono::system_clock::now()); }

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  const Client& client() const { return *client_; }
  grpc::Server& server() { return *server_; }

 private:
  FakeService service_;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
  std::optional<Client> client_;
};

// Answers that keep the protocol: three bricks in two tiles. Tests break one thing at a time.
struct Answers {
  v1::VoxelizeResponse accepted, first, second, summary;

  explicit Answers(uint64_t mesh_bytes) {
    v1::Grid& grid = *accepted.mutable_accepted()->mutable_grid();
    grid.mutable_basis()->mutable_a()->set_x(1);
    grid.mutable_basis()->mutable_b()->set_y(1);
    grid.mutable_basis()->mutable_c()->set_z(1);
    grid.mutable_origin();
    grid.set_voxel_size(1);
    accepted.mutable_accepted()->mutable_index_box()->mutable_min()->set_i(-8);
    auto* max = accepted.mutable_accepted()->mutable_index_box()->mutable_max();
    max->set_i(64);
    max->set_j(64);
    max->set_k(64);
    Digest digest;
    Append({-1, 0, 0}, 1, *first.mutable_bricks(), digest);
    Append({0, 0, 0}, 0xF0, *second.mutable_bricks(), digest);
    Append({0, 7, 1}, 2, *second.mutable_bricks(), digest);
    first.mutable_bricks()->set_progress(0.5);
    second.mutable_bricks()->set_progress(1);
    v1::Summary& end = *summary.mutable_summary();
    end.set_voxels(6);
    end.set_bricks(3);
    end.set_tiles(2);
    end.set_mesh_bytes(mesh_bytes);
    end.mutable_certificate()->set_digest(digest.ToHex());
  }

  static void Append(const Vec3i& brick_ijk, uint64_t first_word, v1::BrickBatch& batch, Digest& digest) {
    Brick brick{brick_ijk, {first_word}};
    digest.Add(brick);
    for (const int32_t index : brick_ijk) batch.add_brick_ijk(index);
    batch.mutable_masks()->append(reinterpret_cast<const char*>(brick.mask.data()), sizeof(brick.mask));
  }

  std::vector<v1::VoxelizeResponse> All() const { return {accepted, first, second, summary}; }
};

const std::string kMesh(3000000, 'm');

// Reads everything, then sends these answers.
Behaviour Send(const std::vector<v1::VoxelizeResponse>& answers) {
  return [answers](grpc::ServerContext*, Stream* stream) {
    for (v1::VoxelizeRequest request; stream->Read(&request);) continue;
    for (const auto& answer : answers) stream->Write(answer);
    return grpc::Status::OK;
  };
}

absl::Status CallWith(const std::vector<v1::VoxelizeResponse>& answers) {
  return Fake(Send(answers)).client().Voxelize({}, kMesh, {}).status();
}

TEST(Call, DeliversWhatTheServerSends) {
  const Fake fake(Send(Answers(kMesh.size()).All()));
  std::vector<Brick> bricks;
  int accepted = 0;
  VoxelizeHandlers handlers;
  handlers.on_accepted = [&](const Accepted& a) {
    ++accepted;
    EXPECT_EQ(a.index_box, (IndexBox{{-8, 0, 0}, {64, 64, 64}}));
    return absl::OkStatus();
  };
  handlers.on_bricks = [&](const BrickBatch& batch) {
    bricks.insert(bricks.end(), batch.bricks.begin(), batch.bricks.end());
    return absl::OkStatus();
  };
  const auto summary = fake.client().Voxelize({}, kMesh, handlers);
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(accepted, 1);
  ASSERT_EQ(bricks.size(), 3u);
  EXPECT_EQ(bricks[1].mask[0], 0xF0u);
  EXPECT_EQ(summary->voxels, 6u);
  EXPECT_GT(summary->bytes_sent, kMesh.size());
  EXPECT_LT(summary->bytes_sent, kMesh.size() + 1000);
  EXPECT_GT(summary->bytes_received, 3u * 76);
}

// As of a server that does not know the field.
TEST(Call, TakesNoSeparatingSetForASupercover) {
  VoxelizeRequest request;
  request.cover = Cover::kSupercover;
  Answers answers(kMesh.size());
  const Fake old(Send(answers.All()));
  const absl::Status status = old.client().Voxelize(request, kMesh, {}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kUnimplemented);
  EXPECT_THAT(std::string(status.message()), HasSubstr("cover"));
  answers.summary.mutable_summary()->mutable_certificate()->set_cover("supercover");
  const Fake known(Send(answers.All()));
  EXPECT_TRUE(known.client().Voxelize(request, kMesh, {}).ok());
}

TEST(Call, SendsTheSpecFirstThenTheMeshInPiecesOfAtMostOneMebibyte) {
  v1::VoxelizeSpec spec;
  std::string mesh;
  const Answers answers(kMesh.size());
  const Fake fake([&](grpc::ServerContext* context, Stream* stream) {
    v1::VoxelizeRequest request;
    EXPECT_TRUE(stream->Read(&request) && request.has_spec());
    spec = request.spec();
    while (stream->Read(&request)) {
      EXPECT_TRUE(request.has_mesh_piece());
      EXPECT_LE(request.mesh_piece().size(), size_t{1} << 20);
      mesh += request.mesh_piece();
    }
    (void)context;
    for (const auto& answer : answers.All()) stream->Write(answer);
    return grpc::Status::OK;
  });
  VoxelizeRequest request;
  request.lattice = Basis{{1, 2, 3}, {4, 5, 6}, {7, 8, 9.5}};
  request.resolution = 77;
  request.origin = Vec3d{-1, -2, -3};
  request.separability = 2;
  request.minimal = false;
  request.region = IndexBox{{-5, 0, 5}, {6, 7, 8}};
  request.shard = Shard{3, 8};
  request.solid = Solid{InteriorRule::kWinding, false, true};
  ASSERT_TRUE(fake.client().Voxelize(request, kMesh, {}).ok());
  EXPECT_FALSE(spec.has_band());
  EXPECT_EQ(mesh, kMesh);
  EXPECT_EQ(spec.lattice().basis().c().z(), 9.5);
  EXPECT_EQ(spec.lattice().basis().b().x(), 4);
  EXPECT_EQ(spec.resolution(), 77u);
  EXPECT_EQ(spec.origin().z(), -3);
  EXPECT_EQ(spec.separability(), 2u);
  EXPECT_TRUE(spec.has_minimal() && !spec.minimal());
  EXPECT_EQ(spec.region().min().i(), -5);
  EXPECT_EQ(spec.region().max().k(), 8);
  EXPECT_EQ(spec.shard().index(), 3u);
  EXPECT_EQ(spec.shard().count(), 8u);
  EXPECT_EQ(spec.fill().mode(), v1::FILL_MODE_SOLID);
  EXPECT_EQ(spec.fill().rule(), v1::INTERIOR_RULE_WINDING);
  EXPECT_TRUE(spec.fill().without_surface() && spec.fill().force_open());
  EXPECT_EQ(spec.mesh_bytes(), kMesh.size());
}

// What a broken server sends, and what the error must say about it.
struct Breach {
  const char* name;
  std::function<void(std::vector<v1::VoxelizeResponse>&)> commit;
  const char* says;
};

// Tile (0, 0, 0) with voxel (0, 0, 0) alone, packed.
const std::string kTile0 = std::string(12, '\0') + "\1\1\1\1\1\1";

void Packed(v1::BrickBatch* batch, const std::string& packed) {
  batch->clear_brick_ijk();
  batch->clear_masks();
  batch->set_packed(packed);
}

std::vector<Breach> Breaches() {
  using Messages = std::vector<v1::VoxelizeResponse>;
  const auto first = [](Messages& m) { return m[1].mutable_bricks(); };
  const auto second = [](Messages& m) { return m[2].mutable_bricks(); };
  const auto summary = [](Messages& m) { return m[3].mutable_summary(); };
  return {
      {"nothing at all", [](Messages& m) { m.clear(); }, "without a summary"},
      {"no summary", [](Messages& m) { m.pop_back(); }, "without a summary"},
      {"summary first", [](Messages& m) { m.erase(m.begin(), m.begin() + 3); }, "not Accepted"},
      {"bricks first", [](Messages& m) { m.erase(m.begin()); }, "not Accepted"},
      {"accepted twice", [](Messages& m) { m.insert(m.begin(), m[0]); }, "twice"},
      {"more after the summary", [](Messages& m) { m.push_back(m[1]); }, "after the summary"},
      {"empty answer", [](Messages& m) { m[1].Clear(); }, "empty"},
      {"masks too short", [=](Messages& m) { second(m)->mutable_masks()->pop_back(); }, "127 bytes for 2 bricks"},
      {"masks too long", [=](Messages& m) { second(m)->mutable_masks()->append(64, 'x'); }, "192 bytes for 2"},
      {"masks missing", [=](Messages& m) { second(m)->clear_masks(); }, "0 bytes for 2 bricks"},
      {"ijk not in threes", [=](Messages& m) { second(m)->add_brick_ijk(1); }, "not a multiple of 3"},
      {"empty brick", [=](Messages& m) { m[1].mutable_bricks()->set_masks(std::string(64, '\0')); }, "is empty"},
      {"brick outside", [=](Messages& m) { first(m)->set_brick_ijk(0, -2); }, "outside"},
      {"brick far outside", [=](Messages& m) { first(m)->set_brick_ijk(1, INT32_MAX); }, "outside"},
      {"bricks although none was announced", [](Messages& m) { m[0].mutable_accepted()->clear_index_box(); },
       "no index_box"},
      {"bricks out of order", [=](Messages& m) { second(m)->set_brick_ijk(4, 0), second(m)->set_brick_ijk(5, 0); },
       "out of order"},
      {"tile twice", [](Messages& m) { m[1] = m[2]; }, "came twice"},
      {"batch lost", [](Messages& m) { m.erase(m.begin() + 1); }, "6 voxels after 5"},
      {"voxel count", [=](Messages& m) { summary(m)->set_voxels(7); }, "7 voxels after 6"},
      {"brick count", [=](Messages& m) { summary(m)->set_bricks(4); }, "4 bricks after 3"},
      {"tile count", [=](Messages& m) { summary(m)->set_tiles(3); }, "3 tiles after 2"},
      {"mesh bytes", [=](Messages& m) { summary(m)->set_mesh_bytes(1); }, "1 mesh bytes"},
      {"bit flipped in flight", [=](Messages& m) { (*second(m)->mutable_masks())[0] = '\x0F'; }, "digest"},
      {"no digest", [=](Messages& m) { summary(m)->mutable_certificate()->clear_digest(); }, "digest"},
      {"packed and masks", [=](Messages& m) { second(m)->set_packed("x"); }, "both masks and packed"},
      {"half a tile", [=](Messages& m) { Packed(second(m), std::string(11, 1)); }, "tile at byte 0 of 11: half a tile"},
      {"packed brick outside", [=](Messages& m) { Packed(second(m), std::string(12, 1) + "\1\1\1\1\1\1"); }, "outside"},
      {"packed brick twice", [=](Messages& m) { Packed(second(m), kTile0 + kTile0); }, "brick 0,0,0 is out of order"},
      {"packed bits flipped", [=](Messages& m) { Packed(second(m), kTile0); }, "summary of 6 voxels after 2"},
      {"no zstd frame", [=](Messages& m) { Packed(second(m), kTile0), second(m)->set_packed_bytes(18); }, "zstd"},
      {"a bomb", [=](Messages& m) { Packed(second(m), "x"), second(m)->set_packed_bytes(UINT32_MAX); },
       "packed_bytes 4294967295 exceeds 1048576"},
      {"progress falls", [=](Messages& m) { second(m)->set_progress(0.25); }, "progress"},
      {"progress NaN", [=](Messages& m) { first(m)->set_progress(NAN); }, "progress"},
      {"progress over 1", [=](Messages& m) { second(m)->set_progress(1.5); }, "progress"},
      {"no grid", [](Messages& m) { m[0].mutable_accepted()->clear_grid(); }, "grid"},
      {"singular grid",
       [](Messages& m) { m[0].mutable_accepted()->mutable_grid()->mutable_basis()->mutable_c()->set_z(0); }, "grid"},
      {"NaN origin", [](Messages& m) { m[0].mutable_accepted()->mutable_grid()->mutable_origin()->set_x(NAN); },
       "grid"},
      {"empty box", [](Messages& m) { m[0].mutable_accepted()->mutable_index_box()->mutable_max()->set_j(0); },
       "index_box"},
  };
}

// Tile (-1, 0, 0) with its brick (7, 0, 0), of which (0, 0, 0), and tile (0, 0, 0), which has two bricks: what Answers
// has.
TEST(Call, TakesPackedBricksAsWell) {
  Answers answers(kMesh.size());
  Packed(answers.first.mutable_bricks(), "\xFF\xFF\xFF\xFF" + std::string(8, '\0') + "\x10\x10\x10\1\1\1");
  const std::string second = std::string(12, '\0') + "\5\1\4\1\x08" + "\2\3\3\3" + "\1\1\2";
  Packed(answers.second.mutable_bricks(), second);
  EXPECT_EQ(CallWith(answers.All()), absl::OkStatus());
  // The same as a zstd frame: its magic number, a header that has the size in a byte, one raw block.
  Packed(answers.second.mutable_bricks(), std::string("\x28\xB5\x2F\xFD\x20\x18\xC1\0\0", 9) + second);
  answers.second.mutable_bricks()->set_packed_bytes(24);
  EXPECT_EQ(CallWith(answers.All()), absl::OkStatus());
}

TEST(Call, EveryBreachOfTheProtocolIsDataLossThatNamesIt) {
  for (const Breach& breach : Breaches()) {
    SCOPED_TRACE(breach.name);
    std::vector<v1::VoxelizeResponse> messages = Answers(kMesh.size()).All();
    breach.commit(messages);
    const absl::Status status = CallWith(messages);
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(breach.says));
  }
}

constexpr Band kSignedBand{.width = 2, .is_signed = true};

void SetValues(const std::vector<float>& values, v1::BrickBatch& batch) {
  batch.set_values(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
}

// Answers with a distance for each of the six voxels.
Answers BandAnswers() {
  Answers answers(kMesh.size());
  const std::vector<float> first{-2}, second{0, 1, 2, -0.5F, 1.5F};
  SetValues(first, *answers.first.mutable_bricks());
  SetValues(second, *answers.second.mutable_bricks());
  Digest digest;
  digest.Add(Brick{{-1, 0, 0}, {1}}, first);
  digest.Add(Brick{{0, 0, 0}, {0xF0}}, std::span(second).first(4));
  digest.Add(Brick{{0, 7, 1}, {2}}, std::span(second).last(1));
  v1::BandCertificate& band = *answers.summary.mutable_summary()->mutable_certificate()->mutable_band();
  band.set_width(2);
  band.set_signed_(true);
  band.set_digest(digest.ToHex());
  return answers;
}

absl::Status CallForBand(const Band& band, const Answers& answers, std::vector<float>* values = nullptr) {
  VoxelizeRequest request;
  request.band = band;
  VoxelizeHandlers handlers;
  handlers.on_bricks = [&](const BrickBatch& batch) {
    if (values != nullptr) values->insert(values->end(), batch.values.begin(), batch.values.end());
    return absl::OkStatus();
  };
  return Fake(Send(answers.All())).client().Voxelize(request, kMesh, handlers).status();
}

TEST(BandCall, HandsOnTheDistancesOfAllVoxelsInTheirOrder) {
  std::vector<float> values;
  EXPECT_EQ(CallForBand(kSignedBand, BandAnswers(), &values), absl::OkStatus());
  EXPECT_THAT(values, testing::ElementsAre(-2, 0, 1, 2, -0.5F, 1.5F));
  // The width in voxels is that of the grid that the server reports.
  EXPECT_EQ(CallForBand({.width = 2, .in_voxels = true, .is_signed = true}, BandAnswers()), absl::OkStatus());
}

TEST(BandCall, EveryWrongValueIsDataLossThatNamesIt) {
  const auto breach = [](const std::function<void(Answers&)>& commit, const Band& band, const char* says) {
    Answers answers = BandAnswers();
    commit(answers);
    const absl::Status status = CallForBand(band, answers);
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(says));
  };
  const auto send = [](const std::vector<float>& values) {
    return [values](Answers& a) { SetValues(values, *a.second.mutable_bricks()); };
  };
  const auto certify = [](const std::function<void(v1::Certificate&)>& change) {
    return [change](Answers& a) { change(*a.summary.mutable_summary()->mutable_certificate()); };
  };
  breach(send({0, 1, 2, 0}), kSignedBand, "values has 16 bytes for 5 voxels, not 20");
  breach(send({0, 1, 2, 0, 0, 0}), kSignedBand, "values has 24 bytes for 5 voxels, not 20");
  breach([](Answers& a) { a.second.mutable_bricks()->mutable_values()->pop_back(); }, kSignedBand, "19 bytes");
  breach([](Answers& a) { a.second.mutable_bricks()->clear_values(); }, kSignedBand, "values has 0 bytes");
  breach(send({0, 1, NAN, 0, 0}), kSignedBand, "a distance of nan in a band of 2");
  breach(send({0, 1, 2.0000002F, 0, 0}), kSignedBand, "in a band of 2");
  breach(send({0, 1, -INFINITY, 0, 0}), kSignedBand, "a distance of -inf");
  breach(send({0, 1, -0.0F, 0, 0}), kSignedBand, "a distance of -0 in a signed band");
  breach(send({0, 1, 2, -0.25F, 1.5F}), kSignedBand, "band's digest");
  breach([](Answers&) {}, {.width = 2}, "a distance of -2 in a band without signs");
  breach(certify([](v1::Certificate& c) { c.clear_band(); }), kSignedBand, "a certificate without a band");
  breach(certify([](v1::Certificate& c) { c.mutable_band()->set_width(3); }), kSignedBand, "a band of 3");
  breach(certify([](v1::Certificate& c) { c.mutable_band()->set_signed_(false); }), kSignedBand, "not signed");
}

// The first stream breaks after its first tile; the second brings the rest, and counts and digests of that alone.
TEST(BandCall, AResumedStreamsDigestIsThatOfAllValues) {
  const Answers answers = BandAnswers();
  std::atomic<int> calls = 0;
  const Fake fake([&](grpc::ServerContext*, Stream* stream) {
    v1::VoxelizeRequest request;
    stream->Read(&request);
    EXPECT_EQ(request.spec().band().width(), 2);
    EXPECT_TRUE(request.spec().band().signed_());
    while (stream->Read(&request)) continue;
    stream->Write(answers.accepted);
    if (calls++ == 0) {
      stream->Write(answers.first);
      return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone");
    }
    const std::vector<float> values{0, 1, 2, -0.5F, 1.5F};
    Digest digest, of_values;
    for (const auto& [brick, count] : {std::pair{Brick{{0, 0, 0}, {0xF0}}, 4}, {Brick{{0, 7, 1}, {2}}, 1}}) {
      digest.Add(brick);
      of_values.Add(brick, count == 4 ? std::span(values).first(4) : std::span(values).last(1));
    }
    v1::VoxelizeResponse end = answers.summary;
    end.mutable_summary()->set_voxels(5);
    end.mutable_summary()->set_bricks(2);
    end.mutable_summary()->set_tiles(1);
    end.mutable_summary()->mutable_certificate()->set_digest(digest.ToHex());
    end.mutable_summary()->mutable_certificate()->mutable_band()->set_digest(of_values.ToHex());
    stream->Write(answers.second);
    stream->Write(end);
    return grpc::Status::OK;
  });
  VoxelizeRequest request;
  request.band = kSignedBand;
  const auto summary = fake.client().Voxelize(request, kMesh, {});
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(calls, 2);
  EXPECT_EQ(summary->certificate.band->digest, answers.summary.summary().certificate().band().digest());
}

TEST(BandCall, ValuesThatNobodyAskedForAreRefused) {
  EXPECT_THAT(std::string(CallWith(BandAnswers().All()).message()),
              HasSubstr("values has 4 bytes for 1 voxels without a band"));
}

grpc::Status Detailed() {
  google::rpc::ErrorInfo info;
  info.set_reason("MESH_TOO_LARGE");
  info.set_domain("latvox");
  (*info.mutable_metadata())["field"] = "mesh_bytes";
  (*info.mutable_metadata())["value"] = "3000000";
  (*info.mutable_metadata())["limit"] = "1000";
  google::rpc::RetryInfo retry;
  retry.mutable_retry_delay()->set_seconds(2);
  retry.mutable_retry_delay()->set_nanos(500000000);
  google::rpc::Status status;
  status.add_details()->PackFrom(info);
  status.add_details()->PackFrom(retry);
  return {grpc::StatusCode::RESOURCE_EXHAUSTED, "mesh_bytes 3000000 exceeds 1000", status.SerializeAsString()};
}

CallOptions OneTry() {
  CallOptions options;
  options.retry.max_retries = 0;
  return options;
}

TEST(Call, ErrorsCarryTheServersDetails) {
  const Fake fake([](grpc::ServerContext*, Stream*) { return Detailed(); });
  const absl::Status status = fake.client().Voxelize({}, kMesh, {}, OneTry()).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(status.message(), "mesh_bytes 3000000 exceeds 1000");
  const ErrorDetails details = GetErrorDetails(status);
  EXPECT_EQ(details.reason, "MESH_TOO_LARGE");
  EXPECT_EQ(details.field, "mesh_bytes");
  EXPECT_EQ(details.value, "3000000");
  EXPECT_EQ(details.limit, "1000");
  EXPECT_EQ(details.retry_after, absl::Milliseconds(2500));
}

TEST(Call, GarbageInTheDetailsLeavesTheErrorItself) {
  const Fake fake([](grpc::ServerContext*, Stream*) {
    return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "no", "\xFF\xFF\xFF garbage");
  });
  const absl::Status status = fake.client().Voxelize({}, kMesh, {}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(GetErrorDetails(status).reason, "");
}

TEST(Call, AnEarlyErrorEndsALargeUpload) {
  const Fake fake([](grpc::ServerContext*, Stream* stream) {
    v1::VoxelizeRequest request;
    stream->Read(&request);
    return Detailed();  // with 200 MB not read
  });
  const std::string mesh(200000000, 'm');
  const absl::Time start = absl::Now();
  EXPECT_EQ(fake.client().Voxelize({}, mesh, {}, OneTry()).status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_LT(absl::Now() - start, absl::Seconds(5));
}

TEST(Call, AnswersAreReadWhileTheUploadStillRuns) {
  // This server takes no further piece before its answers have been taken: 40 MB, more than any window.
  const std::string mesh(40000000, 'm');
  std::atomic<int> batches = 0;
  const Fake fake([&](grpc::ServerContext*, Stream* stream) {
    Answers answers(mesh.size());
    v1::VoxelizeRequest request;
    stream->Read(&request);
    stream->Write(answers.accepted);
    v1::VoxelizeResponse nothing;
    nothing.mutable_bricks();
    for (int n = 0; n < 200000; ++n) stream->Write(nothing);
    while (stream->Read(&request)) continue;
    for (const auto& answer : {answers.first, answers.second, answers.summary}) stream->Write(answer);
    return grpc::Status::OK;
  });
  VoxelizeHandlers handlers;
  handlers.on_bricks = [&](const BrickBatch&) { return ++batches, absl::OkStatus(); };
  const auto summary = fake.client().Voxelize({}, mesh, handlers);
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(batches, 200002);
}

// Sends Accepted and then nothing until the call is over.
grpc::Status Hang(grpc::ServerContext* context, Stream* stream) {
  stream->Write(Answers(0).accepted);
  while (!context->IsCancelled()) absl::SleepFor(absl::Milliseconds(1));
  return grpc::Status::CANCELLED;
}

TEST(Call, CancellingFromAnotherThreadEndsIt) {
  const Fake fake(Hang);
  CallOptions options;
  std::thread canceller([cancellation = options.cancellation] {
    absl::SleepFor(absl::Milliseconds(50));
    cancellation.Cancel();
  });
  const absl::Status status = fake.client().Voxelize({}, kMesh, {}, options).status();
  canceller.join();
  EXPECT_EQ(status.code(), absl::StatusCode::kCancelled) << status;
}

TEST(Call, CancellingFromACallbackEndsIt) {
  const Fake fake(Hang);
  CallOptions options;
  VoxelizeHandlers handlers;
  handlers.on_accepted = [&](const Accepted&) { return options.cancellation.Cancel(), absl::OkStatus(); };
  EXPECT_EQ(fake.client().Voxelize({}, kMesh, handlers, options).status().code(), absl::StatusCode::kCancelled);
}

TEST(Call, CancellingBeforehandSendsNothing) {
  std::atomic<int> calls = 0;
  const Fake fake([&](grpc::ServerContext*, Stream*) { return ++calls, grpc::Status::OK; });
  CallOptions options;
  options.cancellation.Cancel();
  EXPECT_EQ(fake.client().Voxelize({}, kMesh, {}, options).status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(calls, 0);
}

TEST(Call, AnErrorOfACallbackEndsItAndIsReturned) {
  const Fake fake(Hang);
  VoxelizeHandlers handlers;
  handlers.on_accepted = [](const Accepted&) { return absl::DataLossError("the disk is full"); };
  EXPECT_EQ(fake.client().Voxelize({}, kMesh, handlers).status(), absl::DataLossError("the disk is full"));
}

TEST(Call, TheDeadlineEndsIt) {
  const Fake fake(Hang);
  CallOptions options;
  options.deadline = absl::Now() + absl::Milliseconds(100);
  EXPECT_EQ(fake.client().Voxelize({}, kMesh, {}, options).status().code(), absl::StatusCode::kDeadlineExceeded);
}

TEST(Call, AServerThatGoesAwayIsUnavailable) {
  std::optional<Fake> fake;
  fake.emplace([&](grpc::ServerContext* context, Stream* stream) {
    Hang(context, stream);
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "shutting down");
  });
  std::thread stopper([&] {
    absl::SleepFor(absl::Milliseconds(50));
    fake->server().Shutdown(std::chrono::system_clock::now());
  });
  EXPECT_EQ(fake->client().Voxelize({}, kMesh, {}, OneTry()).status().code(), absl::StatusCode::kUnavailable);
  stopper.join();
}

TEST(Call, ManyThreadsShareOneClient) {
  const Fake fake(Send(Answers(kMesh.size()).All()));
  std::vector<std::thread> threads;
  for (int n = 0; n < 8; ++n) {
    threads.emplace_back([&] { EXPECT_TRUE(fake.client().Voxelize({}, kMesh, {}).ok()); });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(Connection, LimitsAndHealthAreAsTheServerSays) {
  Fake fake(Hang);
  const auto limits = fake.client().GetLimits();
  ASSERT_TRUE(limits.ok()) << limits.status();
  EXPECT_EQ(limits->max_extent, 65536u);
  EXPECT_EQ(limits->version, "fake");
  auto healthy = fake.client().Health();
  ASSERT_TRUE(healthy.ok()) << healthy.status();
  EXPECT_TRUE(*healthy);
  fake.server().GetHealthCheckService()->SetServingStatus(false);
  healthy = fake.client().Health();
  ASSERT_TRUE(healthy.ok()) << healthy.status();
  EXPECT_FALSE(*healthy);
}

TEST(Connection, RefusedIsUnavailableAtOnceAndNamesTheAddress) {
  for (const std::string address : {"127.0.0.1:1", "unix:/nonexistent/socket"}) {
    const absl::Time start = absl::Now();
    const auto client = Client::Connect(address);
    EXPECT_EQ(client.status().code(), absl::StatusCode::kUnavailable);
    EXPECT_THAT(std::string(client.status().message()), HasSubstr(address));
    EXPECT_LT(absl::Now() - start, absl::Seconds(5));
  }
}

TEST(CancellationHandle, RunsEachSubscriptionOnceAndNoneAfterItIsGone) {
  const Cancellation cancellation, copy = cancellation;
  int gone = 0, there = 0, late = 0;
  {
    const Cancellation::Subscription subscription(cancellation, [&] { ++gone; });
  }
  const Cancellation::Subscription early(copy, [&] { ++there; });
  EXPECT_FALSE(cancellation.cancelled());
  copy.Cancel();
  cancellation.Cancel();
  const Cancellation::Subscription after(cancellation, [&] { ++late; });
  EXPECT_TRUE(cancellation.cancelled());
  EXPECT_EQ(gone, 0);
  EXPECT_EQ(there, 1);
  EXPECT_EQ(late, 1);
}

}  // namespace
}  // namespace latvox::client
