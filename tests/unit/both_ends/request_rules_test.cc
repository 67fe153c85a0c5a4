// Server, SDK and tool follow the one table of rules for every pair of options of a request.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/tool/cli/option_words.h"
#include "core/base/status_payload.h"
#include "core/request/request.h"
#include "core/request/rules.h"
#include "latvox/client.h"
#include "latvox/error.h"
#include "server/listen/server.h"
#include "server/wire/convert.h"
#include "tests/unit/client/files.h"
#include "tests/unit/server/decoders.h"
#include "tests/unit/server/meshes.h"

namespace latvox {
namespace {

using client::Client;
using testing::HasSubstr;

// One option in the form of each layer. `name` is that of the table. The tool gives a band its distances.
struct Spelling {
  std::string name;
  std::function<void(VoxelizeOptions&)> in_core;
  std::function<void(v1::VoxelizeSpec&)> in_protocol;
  std::function<void(client::VoxelizeRequest&)> in_sdk;
  std::vector<std::string> in_tool;
};

std::vector<Spelling> SetSpellings() {
  using Core = VoxelizeOptions;
  using Proto = v1::VoxelizeSpec;
  using Sdk = client::VoxelizeRequest;
  return {
      {"separability",
       [](Core& o) { o.separability = 2; },
       [](Proto& s) { s.set_separability(2); },
       [](Sdk& r) { r.separability = 2; },
       {"--separability", "2"}},
      {"minimal",
       [](Core& o) { o.minimal = true; },
       [](Proto& s) { s.set_minimal(true); },
       [](Sdk& r) { r.minimal = true; },
       {"--minimal"}},
      {"algorithm",
       [](Core& o) { o.algorithm = Algorithm::kBruteForce; },
       [](Proto& s) { s.set_algorithm(v1::ALGORITHM_BRUTE_FORCE); },
       [](Sdk& r) { r.algorithm = client::Algorithm::kBruteForce; },
       {"--algorithm", "brute-force"}},
      {"supercover",
       [](Core& o) { o.set = SupercoverSurface{}; },
       [](Proto& s) { s.mutable_supercover(); },
       [](Sdk& r) { r.set = client::Supercover{}; },
       {"--set", "supercover"}},
      {"solid",
       [](Core& o) { o.set = Solid{}; },
       [](Proto& s) { s.mutable_solid(); },
       [](Sdk& r) { r.set = client::Solid{}; },
       {"--set", "solid"}},
      {"supercover of a solid",
       [](Core& o) { o.set = Solid{.surface = SolidSurface::kSupercover}; },
       [](Proto& s) { s.mutable_solid()->set_surface(v1::SOLID_SURFACE_SUPERCOVER); },
       [](Sdk& r) { r.set = client::Solid{.surface = client::SolidSurface::kSupercover}; },
       {"--set", "supercover-solid"}},
      {"interior alone",
       [](Core& o) { o.set = Solid{.surface = SolidSurface::kNone}; },
       [](Proto& s) { s.mutable_solid()->set_surface(v1::SOLID_SURFACE_NONE); },
       [](Sdk& r) { r.set = client::Solid{.surface = client::SolidSurface::kNone}; },
       {"--set", "interior"}},
      {"band",
       [](Core& o) {
         o.set = Band{2, true};
         o.fields = {Field::kDistance};
       },
       [](Proto& s) {
         s.mutable_band()->set_voxels(2);
         s.add_fields(v1::FIELD_DISTANCE);
       },
       [](Sdk& r) {
         r.set = client::Band{2, true};
         r.fields = {client::Field::kDistance};
       },
       {"--band", "2v"}},
  };
}

std::vector<Spelling> LinkSpellings() {
  return {{"links",
           [](VoxelizeOptions& o) { o.set = Links{}; },
           [](v1::VoxelizeSpec& s) { s.mutable_links(); },
           [](client::VoxelizeRequest& r) { r.set = client::Links{}; },
           {"--set", "links"}}};
}

std::vector<Spelling> WalkSpellings() {
  using Core = VoxelizeOptions;
  using Proto = v1::VoxelizeSpec;
  using Sdk = client::VoxelizeRequest;
  return {
      {"enclosed",
       [](Core& o) { o.set = Enclosed{}; },
       [](Proto& s) { s.mutable_enclosed(); },
       [](Sdk& r) { r.set = client::Enclosed{}; },
       {"--set", "enclosed"}},
      {"connected",
       [](Core& o) {
         o.set = Connected{.seed = {2, 2, 1}, .close = 0, .allow_outside = true};
       },
       [](Proto& s) {
         s.mutable_connected()->mutable_seed()->set_x(2);
         s.mutable_connected()->mutable_seed()->set_y(2);
         s.mutable_connected()->mutable_seed()->set_z(1);
         s.mutable_connected()->set_allow_outside(true);
       },
       [](Sdk& r) {
         r.set = client::Connected{.seed = {2, 2, 1}, .close = 0, .allow_outside = true};
       },
       {"--set", "region", "--seed", "2,2,1", "--allow-outside"}},
  };
}

std::vector<Spelling> FractionSpellings() {
  return {{"fraction",
           [](VoxelizeOptions& o) {
             o.fields = {Field::kFraction};
             o.fraction_n = 2;
           },
           [](v1::VoxelizeSpec& s) {
             s.clear_fields();
             s.add_fields(v1::FIELD_FRACTION);
             s.set_fraction_n(2);
           },
           [](client::VoxelizeRequest& r) {
             r.fields = {client::Field::kFraction};
             r.fraction_n = 2;
           },
           {"--fields", "fraction:2"}},
          {"open solid",
           [](VoxelizeOptions& o) { o.set = Solid{.force_open = true}; },
           [](v1::VoxelizeSpec& s) { s.mutable_solid()->set_force_open(true); },
           [](client::VoxelizeRequest& r) { r.set = client::Solid{.force_open = true}; },
           {"--set", "solid", "--force-open"}}};
}

std::vector<Spelling> PartSpellings() {
  using Core = VoxelizeOptions;
  using Proto = v1::VoxelizeSpec;
  using Sdk = client::VoxelizeRequest;
  const auto set_region = [](Proto& spec) {
    v1::Ijk& max = *spec.mutable_region()->mutable_max();
    max.set_i(9), max.set_j(9), max.set_k(9);
  };
  const auto set_bounds = [](Proto& spec) {
    spec.mutable_bounds()->mutable_min()->set_x(0);
    v1::Vector3& max = *spec.mutable_bounds()->mutable_max();
    max.set_x(9), max.set_y(9), max.set_z(9);
  };
  return {
      {"fields",
       [](Core& o) { o.fields = {Field::kPart}; },
       [](Proto& s) {
         s.clear_fields();
         s.add_fields(v1::FIELD_PART);
       },
       [](Sdk& r) { r.fields = {client::Field::kPart}; },
       {"--fields", "part"}},
      {"region",
       [](Core& o) {
         o.region = IndexBox{{0, 0, 0}, {9, 9, 9}};
       },
       set_region,
       [](Sdk& r) {
         r.region = client::IndexBox{{0, 0, 0}, {9, 9, 9}};
       },
       {"--region", "0,0,0,9,9,9"}},
      {"bounds",
       [](Core& o) {
         o.bounds = Bounds{{0, 0, 0}, {9, 9, 9}};
       },
       set_bounds,
       [](Sdk& r) {
         r.bounds = client::WorldBox{{0, 0, 0}, {9, 9, 9}};
       },
       {"--bounds", "0,0,0,9,9,9"}},
      {"shard",
       [](Core& o) {
         o.shard = Shard{0, 2};
       },
       [](Proto& s) { s.mutable_shard()->set_count(2); },
       [](Sdk& r) {
         r.shard = client::Shard{0, 2};
       },
       {"--shard", "0/2"}},
      {"verify",
       [](Core& o) { o.verify = true; },
       [](Proto& s) { s.set_verify(true); },
       [](Sdk& r) { r.verify = true; },
       {"--verify"}},
  };
}

std::vector<Spelling> Spellings() {
  std::vector<Spelling> all = SetSpellings();
  for (Spelling& spelling : WalkSpellings()) all.push_back(std::move(spelling));
  for (Spelling& spelling : LinkSpellings()) all.push_back(std::move(spelling));
  for (Spelling& spelling : FractionSpellings()) all.push_back(std::move(spelling));
  for (Spelling& spelling : PartSpellings()) all.push_back(std::move(spelling));
  return all;
}

bool IsSet(const Spelling& spelling) {
  return !spelling.in_tool.empty() && (spelling.in_tool[0] == "--set" || spelling.in_tool[0] == "--band");
}

bool IsFields(const Spelling& spelling) { return !spelling.in_tool.empty() && spelling.in_tool[0] == "--fields"; }

// Message, field and other of a refusal; empty texts if there is none.
struct Answer {
  std::string message, field, other;
  bool operator==(const Answer&) const = default;
  friend void PrintTo(const Answer& answer, std::ostream* out) {
    *out << answer.message << " [" << answer.field << ", " << answer.other << "]";
  }
};

Answer OfTable(const VoxelizeOptions& options) {
  const absl::Status status = CheckRules(options);
  const auto payload = [&](const char* url) { return std::string{status.GetPayload(url).value_or(absl::Cord())}; };
  return {std::string{status.message()}, payload(kRefusedField), payload(kRefusedOther)};
}

Answer OfServer(v1::VoxelizeSpec spec) {
  spec.mutable_lattice()->set_named(v1::NAMED_LATTICE_CARTESIAN);
  spec.set_resolution(9);
  const absl::Status status = JobSpecFromProto(spec, {}).status();
  if (status.ok()) return {};
  return {std::string{status.message()}, CauseOf(status)->field, CauseOf(status)->other};
}

class RequestRules : public client::FilesTest {
 protected:
  void SetUp() override {
    ServerOptions options;
    options.listen = {"unix:" + Path("socket")};
    options.threads = 1;
    options.decoder = TestDecoders();
    auto server = VoxelServer::Start(options);
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    auto connected = Client::Connect(server_->addresses()[0]);
    ASSERT_TRUE(connected.ok()) << connected.status();
    client_.emplace(*std::move(connected));
    drc_ = EncodeDraco(Sphere(4), {});
    Write("part.obj", "v 0 0 0\nv 8 0 0\nv 0 8 0\nv 0 0 8\ng a\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  }

  Answer OfSdk(client::VoxelizeRequest request) {
    request.resolution = 9;
    const absl::Status status = client_->Voxelize(request, drc_, {}).status();
    const client::ErrorDetails details = client::GetErrorDetails(status);
    // Only errors of the request count. The mesh has no attributes, which is another error.
    if (status.ok() || details.reason != "BAD_SPEC") return {};
    return {std::string{status.message()}, details.field, details.other};
  }

  // Returns the tool's exit status and its line on standard error.
  std::pair<int, std::string> OfTool(const std::vector<std::string>& options) {
    const std::string command =
        absl::StrCat(LATVOX, " voxelize ", Path("part.obj"), " --resolution 9 -o ", Path("out.csv"),
                     " --json --server unix:", Path("socket"), " ", absl::StrJoin(options, " "), " 2>&1 >/dev/null");
    FILE* const pipe = popen(command.c_str(), "r");
    std::string line;
    for (int c = fgetc(pipe); c != EOF; c = fgetc(pipe)) line += static_cast<char>(c);
    return {WEXITSTATUS(pclose(pipe)), line};
  }

  std::unique_ptr<VoxelServer> server_;
  std::optional<Client> client_;
  std::string drc_;
};

TEST_F(RequestRules, AreTheSameForServerSdkAndTool) {
  const std::vector<Spelling> spellings = Spellings();
  size_t refused = 0;
  for (size_t n = 0; n < spellings.size(); ++n) {
    for (size_t m = n + 1; m < spellings.size(); ++m) {
      const Spelling &first = spellings[n], &second = spellings[m];
      // A request has one set, and one list of fields.
      if ((IsSet(first) && IsSet(second)) || (IsFields(first) && IsFields(second))) continue;
      SCOPED_TRACE(absl::StrCat(first.name, " and ", second.name));
      VoxelizeOptions options;
      v1::VoxelizeSpec spec;
      client::VoxelizeRequest request;
      for (const Spelling* spelling : {&first, &second}) {
        spelling->in_core(options);
        spelling->in_protocol(spec);
        spelling->in_sdk(request);
      }
      const Answer expected = OfTable(options);
      EXPECT_EQ(OfServer(spec), expected);
      EXPECT_EQ(OfSdk(request), expected);
      std::vector<std::string> words = first.in_tool;
      words.insert(words.end(), second.in_tool.begin(), second.in_tool.end());
      const auto [status, line] = OfTool(words);
      if (expected.message.empty()) {
        EXPECT_EQ(status, 0) << line;
      } else {
        ++refused;
        EXPECT_EQ(status, 2) << line;
        const absl::Status told = client::WithOptions(absl::InvalidArgumentError(expected.message), request);
        EXPECT_THAT(line, HasSubstr(std::string(told.message())));
        EXPECT_THAT(line, HasSubstr("not together with --"));
      }
    }
  }
  EXPECT_EQ(refused,
            Exclusions().size() + 7);  // seven more pairs: one option excludes something that the other one implies
}

TEST(Spellings, NameEveryOptionOfTheTable) {
  std::vector<std::string> names, spelled;
  for (const Option& option : Options()) names.emplace_back(option.name);
  for (const Spelling& spelling : Spellings()) spelled.push_back(spelling.name);
  EXPECT_EQ(spelled, names);
}

}  // namespace
}  // namespace latvox
