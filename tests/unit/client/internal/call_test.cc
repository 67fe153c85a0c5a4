// The SDK against servers with arbitrary answers.
#include <gmock/gmock.h>

#include <functional>
#include <map>
#include <string>

#include "latvox/error.h"
#include "tests/unit/client/fake_server.h"

namespace latvox::client {
namespace {

using testing::HasSubstr;

TEST(Call, DeliversTheServersAnswers) {
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

// A server that does not know a set finds another one.
TEST(Call, TakesNoSeparatingSetForASupercover) {
  VoxelizeRequest request;
  request.set = Supercover{};
  Answers answers(kMesh.size());
  const Fake old(Send(answers.All()));
  const absl::Status status = old.client().Voxelize(request, kMesh, {}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(status.message()), HasSubstr("the set surface instead of supercover"));
  answers.summary.mutable_summary()->mutable_certificate()->set_set("supercover");
  const Fake known(Send(answers.All()));
  EXPECT_TRUE(known.client().Voxelize(request, kMesh, {}).ok());
}

// Returns the metadata that the server receives from a call with these options.
std::multimap<std::string, std::string> MetadataOf(const CallOptions& options) {
  std::multimap<std::string, std::string> seen;
  const Fake fake([&seen](grpc::ServerContext* context, Stream*) {
    for (const auto& [name, value] : context->client_metadata()) {
      seen.emplace(std::string(name.data(), name.size()), std::string(value.data(), value.size()));
    }
    return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "seen");
  });
  EXPECT_EQ(fake.client().Voxelize({}, kMesh, {}, options).status().code(), absl::StatusCode::kInvalidArgument);
  return seen;
}

TEST(Call, CarriesItsTrace) {
  CallOptions options;
  for (const char* good : {"00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01",
                           "cc-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-00-what the future will be like"}) {
    options.traceparent = good;
    options.tracestate = "vendor=t61rcWkgMzE,other@vendor=1";
    const auto metadata = MetadataOf(options);
    EXPECT_THAT(metadata, testing::Contains(testing::Pair("traceparent", options.traceparent)));
    EXPECT_THAT(metadata, testing::Contains(testing::Pair("tracestate", options.tracestate)));
  }
  for (const std::string& bad : {std::string(), std::string("a=1\n"), std::string(513, 'a')}) {
    options.tracestate = bad;
    const auto metadata = MetadataOf(options);
    EXPECT_EQ(metadata.count("traceparent"), 1u);
    EXPECT_EQ(metadata.count("tracestate"), 0u) << bad;
  }
}

TEST(Call, CarriesNoTraceThatIsMalformed) {
  const std::string trace = "4bf92f3577b34da6a3ce929d0e0e4736", span = "00f067aa0ba902b7";
  for (const std::string& bad : {
           std::string(),
           std::string("abc-1"),
           "00-" + trace + "-" + span,
           "00-" + trace + "-" + span + "-0",
           "00-" + trace + "-" + span + "-0x",
           "00-" + trace + "-" + span + "-01-",
           "00-" + trace + "-" + span + "-01-more",
           "cc-" + trace + "-" + span + "-01.more",
           "cc-" + trace + "-" + span + "-01-more\n",
           "ff-" + trace + "-" + span + "-01",
           "0x-" + trace + "-" + span + "-01",
           "00_" + trace + "_" + span + "_01",
           "00-" + std::string(32, '0') + "-" + span + "-01",
           "00-" + trace + "-" + std::string(16, '0') + "-01",
           "00-4BF92F3577B34DA6A3CE929D0E0E4736-" + span + "-01",
       }) {
    CallOptions options;
    options.traceparent = bad;
    options.tracestate = "vendor=1";
    const auto metadata = MetadataOf(options);
    EXPECT_EQ(metadata.count("traceparent"), 0u) << bad;
    EXPECT_EQ(metadata.count("tracestate"), 0u) << bad;
  }
}

TEST(Call, SendsTheSpecFirstThenTheMeshInPiecesOfAtMostOneMebibyte) {
  v1::VoxelizeSpec spec;
  std::string mesh;
  Answers answers(kMesh.size());
  answers.summary.mutable_summary()->mutable_certificate()->set_set("interior");
  const Fake fake([&](grpc::ServerContext*, Stream* stream) {
    v1::VoxelizeRequest request;
    EXPECT_TRUE(stream->Read(&request) && request.has_spec());
    spec = request.spec();
    while (stream->Read(&request)) {
      EXPECT_TRUE(request.has_mesh_piece());
      EXPECT_LE(request.mesh_piece().size(), size_t{1} << 20);
      mesh += request.mesh_piece();
    }
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
  request.bounds = WorldBox{{-1.5, 0, 2}, {3, 4, 5.25}};
  request.shard = Shard{3, 8};
  request.set = Solid{InteriorRule::kWinding, SolidSurface::kNone, true, Field::kMaterial, {7, 0}};
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
  EXPECT_EQ(spec.bounds().min().x(), -1.5);
  EXPECT_EQ(spec.bounds().max().z(), 5.25);
  EXPECT_EQ(spec.shard().index(), 3u);
  EXPECT_EQ(spec.shard().count(), 8u);
  EXPECT_EQ(spec.solid().rule(), v1::INTERIOR_RULE_WINDING);
  EXPECT_EQ(spec.solid().surface(), v1::SOLID_SURFACE_NONE);
  EXPECT_TRUE(spec.solid().force_open());
  EXPECT_EQ(spec.solid().labels(), v1::FIELD_MATERIAL);
  EXPECT_THAT(spec.solid().priority(), testing::ElementsAre(7U, 0U));
  EXPECT_EQ(spec.mesh_bytes(), kMesh.size());
}

// A fault of a server's answers, and a part of the error's message.
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
       "4294967295 bytes exceed 1048576"},
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

// The bricks of Answers: voxel (0, 0, 0) of brick (7, 0, 0) in tile (-1, 0, 0), and two bricks in tile (0, 0, 0).
TEST(Call, TakesPackedBricksAsWell) {
  Answers answers(kMesh.size());
  Packed(answers.first.mutable_bricks(), "\xFF\xFF\xFF\xFF" + std::string(8, '\0') + "\x10\x10\x10\1\1\1");
  const std::string second = std::string(12, '\0') + "\5\1\4\1\x08" + "\2\3\3\3" + "\1\1\2";
  Packed(answers.second.mutable_bricks(), second);
  EXPECT_EQ(CallWith(answers.All()), absl::OkStatus());
  // The same as a zstd frame: magic number, header with the size in one byte, one raw block.
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

}  // namespace
}  // namespace latvox::client
