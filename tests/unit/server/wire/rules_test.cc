// The contract's rules, one by one: specifications, certificates, limits.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/snap/snap.h"
#include "server/base/errors.h"
#include "server/wire/answers.h"
#include "server/wire/convert.h"
#include "tests/unit/server/error_details.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

v1::VoxelizeSpec GoodSpec() {
  v1::VoxelizeSpec spec;
  spec.mutable_lattice()->set_named(v1::NAMED_LATTICE_BCC);
  spec.set_resolution(64);
  return spec;
}

struct BadSpecCase {
  std::string name;
  std::function<void(v1::VoxelizeSpec&)> spoil;
  std::string message, field;
};

std::vector<BadSpecCase> BadValues() {
  using Spec = v1::VoxelizeSpec;
  return {
      {"no lattice", [](Spec& s) { s.clear_lattice(); }, "lattice: neither named nor basis", "lattice"},
      {"empty lattice", [](Spec& s) { s.mutable_lattice()->clear_kind(); }, "lattice: neither", "lattice"},
      {"unspecified", [](Spec& s) { s.mutable_lattice()->set_named(v1::NAMED_LATTICE_UNSPECIFIED); },
       "lattice.named 0 is not a lattice", "lattice.named"},
      {"unknown", [](Spec& s) { s.mutable_lattice()->set_named(static_cast<v1::NamedLattice>(9)); },
       "lattice.named 9 is not a lattice", "lattice.named"},
      {"singular", [](Spec& s) { s.mutable_lattice()->mutable_basis()->mutable_a()->set_x(1); }, "", "lattice.basis"},
      {"no sampling", [](Spec& s) { s.clear_sampling(); }, "sampling: a named lattice needs", "sampling"},
      {"resolution 0", [](Spec& s) { s.set_resolution(0); }, "resolution 0 is below 2", "resolution"},
      {"resolution 1", [](Spec& s) { s.set_resolution(1); }, "resolution 1 is below 2", "resolution"},
      {"resolution 70000", [](Spec& s) { s.set_resolution(70000); }, "resolution 70000 exceeds 65536", "resolution"},
      {"voxel_size 0", [](Spec& s) { s.set_voxel_size(0); }, "voxel_size 0 is not a finite number above 0",
       "voxel_size"},
      {"voxel_size -1", [](Spec& s) { s.set_voxel_size(-1); }, "voxel_size -1 is not", "voxel_size"},
      {"voxel_size inf", [](Spec& s) { s.set_voxel_size(kInfinity); }, "voxel_size inf is not", "voxel_size"},
      {"voxel_size nan", [](Spec& s) { s.set_voxel_size(std::nan("")); }, "voxel_size nan is not", "voxel_size"},
      {"separability 3", [](Spec& s) { s.set_separability(3); }, "separability 3 exceeds 2", "separability"},
      {"algorithm 5", [](Spec& s) { s.set_algorithm(static_cast<v1::Algorithm>(5)); },
       "algorithm 5 is not an algorithm", "algorithm"},
      {"surface 4", [](Spec& s) { s.mutable_solid()->set_surface(static_cast<v1::SolidSurface>(4)); },
       "solid.surface 4 is not a surface", "solid.surface"},
      {"field 13", [](Spec& s) { s.add_fields(static_cast<v1::Field>(13)); }, "fields 13 is not a field", "fields"},
      {"points", [](Spec& s) { s.set_fraction_n(8); }, "fraction_n 8: needs fraction or label_fractions among fields",
       "fraction_n"},
      {"labels of fractions", [](Spec& s) { s.add_fraction_labels(3); },
       "fraction_labels: needs label_fractions among fields", "fraction_labels"},
      {"no points", [](Spec& s) { s.add_fields(v1::FIELD_FRACTION); }, "fraction_n 0 is below 2", "fraction_n"},
      {"signs", [](Spec& s) { s.set_signed_distance(true); }, "needs distance among fields", "signed_distance"},
      {"rule 4", [](Spec& s) { s.set_interior_rule(static_cast<v1::InteriorRule>(4)); },
       "interior_rule 4 is not a rule", "interior_rule"},
      {"rule of nothing", [](Spec& s) { s.set_interior_rule(v1::INTERIOR_RULE_PARITY); },
       "interior_rule parity: needs signed_distance", "interior_rule"},
      {"encoding 4", [](Spec& s) { s.set_encoding(static_cast<v1::BrickEncoding>(4)); },
       "encoding 4 is not an encoding", "encoding"}};
}

std::vector<BadSpecCase> BadParts() {
  using Spec = v1::VoxelizeSpec;
  const auto set_region = [](Spec& s, int low, int high) {
    s.mutable_region()->mutable_min()->set_j(low);
    v1::Ijk& max = *s.mutable_region()->mutable_max();
    max.set_i(5);
    max.set_j(high);
    max.set_k(5);
  };
  const auto set_bounds = [](Spec& s, double low, double high) {
    s.mutable_bounds()->mutable_min()->set_y(low);
    s.mutable_bounds()->mutable_max()->set_y(high);
  };
  return {
      {"origin", [](Spec& s) { s.mutable_origin()->set_y(kInfinity); }, "origin.y inf is not finite", "origin.y"},
      {"region without max", [](Spec& s) { s.mutable_region(); }, "region.max.i 0 is not above", "region.max.i"},
      {"empty region", [=](Spec& s) { set_region(s, 4, 4); }, "region.max.j 4 is not above region.min's 4",
       "region.max.j"},
      {"region backwards", [=](Spec& s) { set_region(s, 4, -4); }, "region.max.j -4 is not above", "region.max.j"},
      {"no bounds", [](Spec& s) { s.mutable_bounds(); }, "bounds.min is not set", "bounds.min"},
      {"half of bounds", [](Spec& s) { s.mutable_bounds()->mutable_min(); }, "bounds.max is not set", "bounds.max"},
      {"endless bounds", [=](Spec& s) { set_bounds(s, 0, kInfinity); }, "bounds.max.y inf is not finite",
       "bounds.max.y"},
      {"bounds backwards", [=](Spec& s) { set_bounds(s, 4, 3.5); }, "bounds.max.y 3.5 is below bounds.min's 4",
       "bounds.max.y"},
      {"mesh_sha256", [](Spec& s) { s.set_mesh_sha256("abc"); }, "mesh_sha256 has 3 bytes, not 32", "mesh_sha256"},
      {"no shard", [](Spec& s) { s.mutable_shard(); }, "shard.count 0 is not within 1 to 1048576", "shard.count"},
      {"too many shards", [](Spec& s) { s.mutable_shard()->set_count((1 << 20) + 1); },
       "shard.count 1048577 is not within 1 to 1048576", "shard.count"},
      {"shard 3 of 3",
       [](Spec& s) {
         s.mutable_shard()->set_index(3);
         s.mutable_shard()->set_count(3);
       },
       "shard.index 3 is not below shard.count 3", "shard.index"},
      {"empty band", [](Spec& s) { s.mutable_band(); }, "band: neither width nor voxels is set", "band"},
      {"band 0", [](Spec& s) { s.mutable_band()->set_width(0); }, "band.width 0 is not a finite number above 0",
       "band.width"},
      {"band nan", [](Spec& s) { s.mutable_band()->set_voxels(std::nan("")); }, "band.voxels nan is not",
       "band.voxels"},
  };
}

TEST(JobSpecFromProto, NamesTheFieldOfEveryBadSpec) {
  std::vector<BadSpecCase> cases = BadValues();
  std::ranges::move(BadParts(), std::back_inserter(cases));
  for (const BadSpecCase& bad : cases) {
    SCOPED_TRACE(bad.name);
    v1::VoxelizeSpec spec = GoodSpec();
    bad.spoil(spec);
    const auto result = JobSpecFromProto(spec, {});
    ASSERT_FALSE(result.ok());
    EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string{result.status().message()}, HasSubstr(bad.message));
    const google::rpc::ErrorInfo info = ErrorInfoOf(ToGrpcStatus(result.status()));
    EXPECT_EQ(info.reason(), "BAD_SPEC");
    EXPECT_EQ(info.metadata().at("field"), bad.field);
  }
}

TEST(JobSpecFromProto, FillsInTheContractsDefaults) {
  const auto spec = JobSpecFromProto(GoodSpec(), {});
  ASSERT_TRUE(spec.ok()) << spec.status();
  EXPECT_EQ(spec->grid.lattice.name(), "bcc");
  EXPECT_EQ(spec->grid.sampling.resolution, 64);
  EXPECT_FALSE(spec->grid.sampling.voxel_size || spec->grid.origin || spec->request.part.region ||
               spec->request.part.bounds);
  EXPECT_FALSE(spec->request.verify);
  EXPECT_TRUE(spec->request.is_minimal());
  EXPECT_EQ(spec->request.separability, 0);
  EXPECT_EQ(spec->request.algorithm(), Algorithm::kExact);
}

TEST(JobSpecFromProto, KnowsEveryAlgorithmByTheNameOfItsNumber) {
  v1::VoxelizeSpec proto = GoodSpec();
  for (const auto& [algorithm, name] : kAlgorithms) {
    std::string number = absl::StrCat("ALGORITHM_", absl::AsciiStrToUpper(std::string{name}));
    std::replace(number.begin(), number.end(), '-', '_');
    v1::Algorithm value = v1::ALGORITHM_UNSPECIFIED;
    ASSERT_TRUE(v1::Algorithm_Parse(number, &value)) << number;
    proto.set_algorithm(value);
    EXPECT_EQ(JobSpecFromProto(proto, {})->request.algorithm(), algorithm);
  }
}

TEST(JobSpecFromProto, TakesEveryField) {
  v1::VoxelizeSpec proto = GoodSpec();
  proto.set_voxel_size(0.25);
  proto.mutable_origin()->set_z(-3);
  proto.set_separability(2);
  proto.set_minimal(false);
  proto.mutable_region()->mutable_min()->set_i(-7);
  for (const auto set : {&v1::Ijk::set_i, &v1::Ijk::set_j, &v1::Ijk::set_k}) {
    (proto.mutable_region()->mutable_max()->*set)(9);
  }
  proto.mutable_bounds()->mutable_min()->set_x(-0.5);
  proto.mutable_bounds()->mutable_max()->set_z(7);
  proto.mutable_shard()->set_index(2);
  proto.mutable_shard()->set_count(5);
  proto.set_mesh_bytes(77);
  const auto spec = JobSpecFromProto(proto, {});
  ASSERT_TRUE(spec.ok()) << spec.status();
  EXPECT_EQ(spec->grid.sampling.voxel_size, 0.25);
  EXPECT_FALSE(spec->grid.sampling.resolution);
  EXPECT_EQ(spec->grid.origin, (Vec3d{0, 0, -3}));
  EXPECT_EQ(spec->request.separability, 2);
  EXPECT_FALSE(spec->request.is_minimal());
  EXPECT_EQ(spec->request.part.region, (IndexBox{{-7, 0, 0}, {9, 9, 9}}));
  ASSERT_TRUE(spec->request.part.shard && spec->request.part.bounds);
  EXPECT_EQ(spec->request.part.bounds->min, (Vec3d{-0.5, 0, 0}));
  EXPECT_EQ(spec->request.part.bounds->max, (Vec3d{0, 0, 7}));
  EXPECT_EQ(spec->request.part.shard->index, 2U);
  EXPECT_EQ(spec->request.part.shard->count, 5U);
  EXPECT_EQ(spec->mesh_bytes, 77);
}

TEST(JobSpecFromProto, ASupercoverIsNotMinimalAndSaysSo) {
  v1::VoxelizeSpec proto = GoodSpec();
  JobSpec spec = *JobSpecFromProto(proto, {});
  EXPECT_FALSE(spec.request.is_supercover());
  EXPECT_EQ(CertificateToProto(spec, {}, {}, {}, std::nullopt).set(), "surface");
  proto.mutable_supercover();
  spec = *JobSpecFromProto(proto, {});
  EXPECT_TRUE(spec.request.is_supercover());
  const v1::Certificate certificate = CertificateToProto(spec, {}, {}, {}, std::nullopt);
  EXPECT_EQ(certificate.set(), "supercover");
  EXPECT_TRUE(certificate.tunnel_free());
  EXPECT_FALSE(certificate.minimal());
  proto.set_minimal(false);
  EXPECT_TRUE(JobSpecFromProto(proto, {}).ok());
}

TEST(JobSpecFromProto, LetsABasisStandForItself) {
  v1::VoxelizeSpec proto = GoodSpec();
  proto.clear_sampling();
  v1::Basis& basis = *proto.mutable_lattice()->mutable_basis();
  basis.mutable_a()->set_x(2);
  basis.mutable_b()->set_y(2);
  basis.mutable_c()->set_z(2);
  const auto spec = JobSpecFromProto(proto, {});
  ASSERT_TRUE(spec.ok()) << spec.status();
  EXPECT_DOUBLE_EQ(spec->grid.lattice.voxel_size(), 2);
  EXPECT_FALSE(spec->grid.sampling.resolution || spec->grid.sampling.voxel_size);
}

TEST(JobSpecFromProto, RefusesAnOversizedMeshBeforeItIsSent) {
  v1::VoxelizeSpec proto = GoodSpec();
  proto.set_mesh_bytes(2000);
  const auto result = JobSpecFromProto(proto, {.max_mesh_bytes = 1000});
  EXPECT_EQ(result.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(result.status().message(), "mesh_bytes 2000 exceeds 1000");
}

TEST(Certificate, ClaimsMinimalityOnlyOfWholeSurfaces) {
  JobSpec spec = *JobSpecFromProto(GoodSpec(), {});
  JobFacts facts;
  facts.index_box = IndexBox{{0, 0, 0}, {10, 10, 10}};
  const auto minimal = [&] { return CertificateToProto(spec, facts, {}, {}, std::nullopt).minimal(); };
  EXPECT_TRUE(minimal());
  spec.request.part.region = IndexBox{{-1, -1, -1}, {11, 11, 11}};
  EXPECT_TRUE(minimal());
  spec.request.part.region->max[2] = 10;  // the box may have been cut here
  EXPECT_FALSE(minimal());
  spec.request.part.region.reset();
  EXPECT_TRUE(minimal());
  facts.cut_by_bounds = true;
  spec.request.part.shard = Shard{0, 2};
  EXPECT_FALSE(minimal());
  EXPECT_FALSE(CertificateToProto(spec, facts, {}, {}, std::nullopt).whole_minimal());
  spec.request.part.shard.reset();
  EXPECT_FALSE(minimal());
  facts.cut_by_bounds = false;
  spec.request.part.region = IndexBox{{-1, -1, -1}, {11, 11, 11}};
  facts.index_box.reset();
  EXPECT_FALSE(minimal());
  spec.request.part.region.reset();
  for (const uint32_t count : {1U, 2U}) {
    spec.request.part.shard = Shard{0, count};
    EXPECT_EQ(minimal(), count == 1);
    EXPECT_TRUE(CertificateToProto(spec, facts, {}, {}, std::nullopt).whole_minimal());
    EXPECT_EQ(CertificateToProto(spec, facts, {}, {}, std::nullopt).shard().count(), count);
  }
  spec.request.part.shard.reset();
  spec.request.set = SurfaceSet{.minimal = false};
  EXPECT_FALSE(minimal());
  EXPECT_FALSE(CertificateToProto(spec, facts, {}, {}, std::nullopt).whole_minimal());
}

TEST(Certificate, OfABandSaysWhatItIsAndClaimsNothingOfASurface) {
  v1::VoxelizeSpec asked = GoodSpec();
  asked.mutable_band()->set_voxels(2);
  asked.add_fields(v1::FIELD_DISTANCE);
  asked.set_signed_distance(true);
  JobFacts facts;
  facts.band_width = 0.5;
  facts.interior_rule = InteriorRule::kWinding;
  const v1::Certificate certificate = CertificateToProto(*JobSpecFromProto(asked, {}), facts, {}, {}, std::nullopt);
  EXPECT_FALSE(certificate.tunnel_free() || certificate.minimal());
  EXPECT_EQ(certificate.band().width(), 0.5);
  EXPECT_EQ(certificate.set(), "band");
  EXPECT_TRUE(certificate.signed_distance());
  EXPECT_EQ(certificate.interior_rule(), "winding");
  ASSERT_EQ(certificate.fields_size(), 1);
  EXPECT_EQ(certificate.fields(0).field(), v1::FIELD_DISTANCE);
  EXPECT_EQ(certificate.fields(0).digest(), Digest().ToHex());
}

TEST(Certificate, OfAFractionHasTheNumberOfItsPoints) {
  v1::VoxelizeSpec asked = GoodSpec();
  asked.add_fields(v1::FIELD_FRACTION);
  asked.set_fraction_n(8);
  const v1::Certificate certificate = CertificateToProto(*JobSpecFromProto(asked, {}), {}, {}, {}, std::nullopt);
  EXPECT_EQ(certificate.fraction_n(), 8U);
  EXPECT_EQ(certificate.fields(0).field(), v1::FIELD_FRACTION);
}

TEST(Certificate, OfFractionsOfLabelsHasTheLabels) {
  v1::VoxelizeSpec asked = GoodSpec();
  asked.mutable_solid()->set_labels(v1::FIELD_PART);
  asked.add_fields(v1::FIELD_PART);
  asked.add_fields(v1::FIELD_LABEL_FRACTIONS);
  asked.set_fraction_n(8);
  for (const uint32_t label : {7U, 3U}) asked.add_fraction_labels(label);
  const JobSpec spec = *JobSpecFromProto(asked, {});
  EXPECT_EQ(spec.request.fraction_labels, (std::vector<uint32_t>{7, 3}));
  const Grid grid{Lattice::Named(NamedLattice::kCartesian), {0, 0, 0}};
  const JobFacts facts{.fraction_labels = {7, 3}};
  const v1::Certificate certificate = CertificateToProto(spec, facts, {}, {}, std::nullopt);
  EXPECT_THAT(certificate.fraction_labels(), testing::ElementsAre(7, 3));
  EXPECT_EQ(certificate.fields(1).field(), v1::FIELD_LABEL_FRACTIONS);
  const v1::Accepted accepted = AcceptedToProto("id", spec.request, grid, Placement::kCells, facts, {});
  EXPECT_THAT(accepted.fraction_labels(), testing::ElementsAre(7, 3));
}

TEST(Certificate, ClaimsOfAnotherAlgorithmThanTheExactOneOnlyWhatWasCounted) {
  JobSpec spec = *JobSpecFromProto(GoodSpec(), {});
  spec.request.set = SurfaceSet{.algorithm = Algorithm::kIncremental, .minimal = false};
  const auto claims = [&](const std::optional<Verdict>& verdict) {
    const v1::Certificate certificate = CertificateToProto(spec, {}, {}, {}, verdict);
    EXPECT_EQ(certificate.algorithm(), "incremental");
    EXPECT_EQ(certificate.verified(), verdict.has_value());
    return std::pair(certificate.tunnel_free(), certificate.minimal());
  };
  Verdict verdict;
  EXPECT_EQ(claims(std::nullopt), std::pair(false, false));
  EXPECT_EQ(claims(verdict), std::pair(true, true));
  verdict.redundant = 1;
  EXPECT_EQ(claims(verdict), std::pair(true, false));
  verdict.tunnels = 1;
  EXPECT_EQ(claims(verdict), std::pair(false, false));
  verdict.redundant = 0;
  EXPECT_EQ(claims(verdict), std::pair(false, false));
}

TEST(Limits, AreReportedAsTheyAreSet) {
  const v1::GetLimitsResponse limits =
      LimitsToProto({.max_mesh_bytes = 1,
                     .max_triangles = 2,
                     .max_vertices = 3,
                     .max_jobs = 4,
                     .max_queued_jobs = 6,
                     .max_jobs_per_client = 7,
                     .max_visited_points = 8,
                     .max_job_time = absl::Seconds(2.5),
                     .memory_budget_bytes = 9,
                     .mesh_store_bytes = 10,
                     .max_message_bytes = 5},
                    {.commit = "abc", .libraries = {{"gRPC", "1.51.1"}, {"oneTBB", "2021.8"}}});
  EXPECT_EQ(limits.max_mesh_bytes(), 1);
  EXPECT_EQ(limits.max_triangles(), 2);
  EXPECT_EQ(limits.max_vertices(), 3);
  EXPECT_EQ(limits.max_jobs(), 4);
  EXPECT_EQ(limits.max_message_bytes(), 5);
  EXPECT_EQ(limits.max_queued_jobs(), 6);
  EXPECT_EQ(limits.max_jobs_per_client(), 7);
  EXPECT_EQ(limits.max_visited_points(), 8);
  EXPECT_EQ(limits.max_job_seconds(), 2.5);
  EXPECT_EQ(limits.memory_budget_bytes(), 9);
  EXPECT_EQ(limits.mesh_store_bytes(), 10);
  EXPECT_EQ(limits.max_extent(), kMaxExtent);
  EXPECT_EQ(limits.subvoxel_bits(), kSubvoxelBits);
  EXPECT_EQ(limits.version(), LATVOX_VERSION);
  EXPECT_EQ(limits.commit(), "abc");
  ASSERT_EQ(limits.libraries_size(), 2);
  EXPECT_EQ(limits.libraries(1).name(), "oneTBB");
  EXPECT_EQ(limits.libraries(1).version(), "2021.8");
  EXPECT_EQ(LimitsToProto({}, {}).max_points(), 131072);
  EXPECT_EQ(LimitsToProto({}, {}).max_pixels(), 419328);
  EXPECT_EQ(LimitsToProto({}, {}).max_crossings(), 16 * 419328);
}

}  // namespace
}  // namespace latvox
