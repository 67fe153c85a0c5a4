// Fill, from the specification to the certificate: what is taken, refused, limited, and said in the end.
#include <gtest/gtest.h>

#include <future>
#include <string>
#include <vector>

#include "core/solid/interior.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "server/base/errors.h"
#include "server/wire/convert.h"
#include "server/work/computation.h"
#include "tests/unit/server/environment.h"
#include "tests/unit/server/meshes.h"
#include "tests/unit/server/thread_decoder.h"

namespace latvox {
namespace {

v1::VoxelizeSpec SolidSpec() {
  v1::VoxelizeSpec spec;
  spec.mutable_lattice()->set_named(v1::NAMED_LATTICE_BCC);
  spec.set_resolution(64);
  spec.set_encoding(v1::BRICK_ENCODING_PACKED);
  spec.mutable_solid();
  return spec;
}

std::string FieldOf(const absl::Status& status) {
  google::rpc::Status details;
  google::rpc::ErrorInfo info;
  EXPECT_TRUE(details.ParseFromString(ToGrpcStatus(status).error_details()));
  EXPECT_TRUE(details.details_size() > 0 && details.details(0).UnpackTo(&info));
  return info.reason() + " " + info.metadata().at("field");
}

TEST(Solid, IsReadFromTheSpecification) {
  v1::VoxelizeSpec proto = SolidSpec();
  const auto solid = [&] {
    const VoxelRequest request = JobSpecFromProto(proto, {})->request;
    return request.solid() != nullptr ? std::optional(*request.solid()) : std::nullopt;
  };
  ASSERT_TRUE(solid());
  EXPECT_TRUE(solid()->rule == InteriorRule::kAuto && solid()->surface == SolidSurface::kSeparating &&
              !solid()->force_open);
  proto.mutable_solid()->set_rule(v1::INTERIOR_RULE_WINDING);
  proto.mutable_solid()->set_surface(v1::SOLID_SURFACE_NONE);
  proto.mutable_solid()->set_force_open(true);
  EXPECT_TRUE(solid()->rule == InteriorRule::kWinding && solid()->surface == SolidSurface::kNone &&
              solid()->force_open);
  EXPECT_FALSE(solid()->labels);
  proto.add_fields(v1::FIELD_MATERIAL);
  proto.mutable_solid()->set_labels(v1::FIELD_MATERIAL);
  proto.mutable_solid()->add_priority(7);
  EXPECT_TRUE(solid()->labels == Field::kMaterial && solid()->priority == std::vector<uint32_t>{7});
  proto.mutable_solid()->set_surface(v1::SOLID_SURFACE_SUPERCOVER);
  EXPECT_TRUE(JobSpecFromProto(proto, {})->request.is_supercover());
  proto.mutable_surface();
  EXPECT_FALSE(solid());
}

TEST(Solid, IsRefusedByItsField) {
  const auto refusal = [](const auto& spoil) {
    v1::VoxelizeSpec proto = SolidSpec();
    spoil(proto);
    const absl::Status status = JobSpecFromProto(proto, {}).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    return FieldOf(status);
  };
  EXPECT_EQ(refusal([](auto& s) { s.mutable_solid()->set_surface(static_cast<v1::SolidSurface>(4)); }),
            "BAD_SPEC solid.surface");
  EXPECT_EQ(refusal([](auto& s) { s.mutable_solid()->set_rule(static_cast<v1::InteriorRule>(4)); }),
            "BAD_SPEC solid.rule");
  EXPECT_EQ(refusal([](auto& s) { s.mutable_solid()->set_labels(static_cast<v1::Field>(99)); }),
            "BAD_SPEC solid.labels");
  EXPECT_EQ(refusal([](auto& s) { s.mutable_solid()->set_labels(v1::FIELD_PART); }), "BAD_SPEC solid.labels");
  EXPECT_EQ(refusal([](auto& s) { s.mutable_solid()->add_priority(1); }), "BAD_SPEC solid.priority");
  EXPECT_EQ(refusal([](auto& s) { s.set_verify(true); }), "BAD_SPEC verify");
  EXPECT_EQ(refusal([](auto& s) { s.set_algorithm(v1::ALGORITHM_BRUTE_FORCE); }), "BAD_SPEC solid");
}

// The facts of the whole computation: its status, its messages, and the memory that it held before its bricks.
struct Outcome {
  absl::Status status;
  std::vector<v1::VoxelizeResponse> messages;
  uint64_t memory = 0;
  const v1::Summary& summary() const { return messages.back().summary(); }
};

Outcome Compute(const v1::VoxelizeSpec& proto, const TriangleMesh& mesh, const Limits& limits = {}) {
  ThreadDecoder decoder;
  TestEnvironment environment(decoder, limits);
  Computation computation(*JobSpecFromProto(proto, {}), "id", environment.shared());
  Outcome outcome;
  MeshUpload upload(0, 1 << 30);
  EXPECT_TRUE(upload.Append(EncodeDraco(mesh, {})).ok());
  EXPECT_TRUE(computation.ReceiveMesh(std::move(upload)).ok());
  std::promise<absl::Status> decoded;
  computation.Decode([&](const absl::Status& status) { decoded.set_value(status); });
  EXPECT_TRUE(decoded.get_future().get().ok());
  const auto deliver = [&](v1::VoxelizeResponse&& message) {
    outcome.messages.push_back(std::move(message));
    return true;
  };
  outcome.status = computation.Measure();
  if (outcome.status.ok()) outcome.status = computation.Start(deliver);
  outcome.memory = environment.memory.reserved();
  while (outcome.status.ok()) {
    const absl::StatusOr<bool> done = computation.Advance(deliver, [] { return false; });
    outcome.status = done.status();
    if (!done.ok() || *done) break;
  }
  return outcome;
}

TEST(Solid, IsInTheCertificate) {
  v1::VoxelizeSpec proto = SolidSpec();
  const Outcome solid = Compute(proto, Sphere(20));
  ASSERT_TRUE(solid.status.ok()) << solid.status;
  const v1::Certificate& certificate = solid.summary().certificate();
  EXPECT_EQ(certificate.solid().rule(), "winding");  // by auto
  EXPECT_TRUE(certificate.set() == "solid" && certificate.tunnel_free() && certificate.minimal());
  proto.mutable_solid()->set_rule(v1::INTERIOR_RULE_WINDING);
  proto.mutable_solid()->set_surface(v1::SOLID_SURFACE_NONE);
  const Outcome inside = Compute(proto, Sphere(20));
  ASSERT_TRUE(inside.status.ok()) << inside.status;
  EXPECT_EQ(inside.summary().certificate().solid().rule(), "winding");
  EXPECT_EQ(inside.summary().certificate().set(), "interior");
  EXPECT_FALSE(inside.summary().certificate().tunnel_free() || inside.summary().certificate().minimal());
  proto.clear_solid();
  const Outcome surface = Compute(proto, Sphere(20));
  EXPECT_FALSE(surface.summary().certificate().has_solid());
  EXPECT_GT(solid.summary().voxels(), inside.summary().voxels());
  EXPECT_LT(solid.summary().voxels(), inside.summary().voxels() + surface.summary().voxels());
}

TEST(Solid, OfAMeshThatIsNotClosedIsABadMeshBeforeAnythingIsDelivered) {
  TriangleMesh mesh = Sphere(20);
  mesh.triangles.resize(mesh.triangles.size() - 300);
  v1::VoxelizeSpec proto = SolidSpec();
  const Outcome refused = Compute(proto, mesh);
  EXPECT_EQ(refused.status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(FieldOf(refused.status), "BAD_MESH mesh");
  EXPECT_TRUE(refused.messages.empty());
  proto.mutable_solid()->set_force_open(true);
  const Outcome forced = Compute(proto, mesh);
  ASSERT_TRUE(forced.status.ok()) << forced.status;
  EXPECT_GT(forced.summary().certificate().solid().unbalanced_lines(), 0U);
  EXPECT_FALSE(forced.summary().certificate().closed());
  // All crossings of its lines are kept, and counted.
  EXPECT_GT(forced.memory, Compute(SolidSpec(), Sphere(20)).memory);
}

// A shard of a large flat solid has few voxels, but looks at all its lines first.
TEST(Solid, CountsWhatComesBeforeTheFirstTile) {
  constexpr float kSide = 16384;
  constexpr uint64_t kCrossings = 2 * 256 * 256;
  TriangleMesh mesh;
  for (const float x : {0.F, kSide}) {
    for (const float y : {0.F, kSide}) mesh.vertices.insert(mesh.vertices.end(), {{x, y, 0}, {x, y, 1}});
  }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 6, 7}, {4, 7, 5}, {0, 4, 5}, {0, 5, 1},
                    {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 5, 7}, {1, 7, 3}};
  v1::VoxelizeSpec proto = SolidSpec();
  proto.mutable_lattice()->set_named(v1::NAMED_LATTICE_CARTESIAN);
  proto.set_voxel_size(1);
  proto.mutable_shard()->set_count(1 << 20);
  const Outcome flat = Compute(proto, mesh);
  ASSERT_TRUE(flat.status.ok()) << flat.status;
  EXPECT_GE(flat.memory, Compute(proto, Sphere(20)).memory + kCrossings * kBytesPerLineCrossing);
  EXPECT_EQ(Compute(proto, mesh, {.max_visited_points = 4 * kCrossings}).status.code(),
            absl::StatusCode::kResourceExhausted);
}

TEST(Solid, CountsAgainstTheLimitOfVoxels) {
  v1::VoxelizeSpec proto = SolidSpec();
  const uint64_t limit = 50000;  // more than the surface has
  EXPECT_EQ(Compute(proto, Sphere(20), {.max_visited_points = limit}).status.code(),
            absl::StatusCode::kResourceExhausted);
  proto.clear_solid();
  EXPECT_TRUE(Compute(proto, Sphere(20), {.max_visited_points = limit}).status.ok());
}

// A solid's bricks are full, except those at its surface. They take the bytes that the format's description tells.
TEST(Solid, PacksFullBricks) {
  v1::VoxelizeSpec proto = SolidSpec();
  proto.set_resolution(400);
  for (const auto encoding : {v1::BRICK_ENCODING_MASKS, v1::BRICK_ENCODING_PACKED, v1::BRICK_ENCODING_PACKED_ZSTD}) {
    proto.set_encoding(encoding);
    const Outcome solid = Compute(proto, Sphere(20));
    ASSERT_TRUE(solid.status.ok()) << solid.status;
    size_t bytes = 0;
    for (const auto& message : solid.messages) bytes += message.bricks().ByteSizeLong();
    const double each = static_cast<double>(bytes) / static_cast<double>(solid.summary().bricks());
    RecordProperty(std::to_string(encoding), std::to_string(each));
    EXPECT_LT(each, encoding == v1::BRICK_ENCODING_MASKS ? 77 : encoding == v1::BRICK_ENCODING_PACKED ? 10 : 10);
  }
}

}  // namespace
}  // namespace latvox
