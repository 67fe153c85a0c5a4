// No field of a request reaches users of the tool: the rules of core and server, in words of options.
#include "client/tool/cli/option_words.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/status_payload.h"
#include "core/request/rules.h"
#include "latvox/error.h"
#include "latvox/v1/voxelizer.pb.h"

namespace latvox {
namespace {

using Options = VoxelizeOptions;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A breach of a rule about one option, the set of the request in the SDK, and what the tool says.
struct Case {
  std::string rule;
  std::function<void(Options&)> spoil;
  client::VoxelSet set;
  std::string expected;
};

std::vector<Case> CasesOfLabels() {
  return {
      {"solid.labels", [](Options& o) { o.set = Solid{.labels = Field::kPart}; }, client::Solid{},
       "--labels part: needs part among --fields"},
      {"solid.priority", [](Options& o) { o.set = Solid{.priority = {1}}; }, client::Solid{},
       "--priority: needs --labels"},
      {"enclosed.labels", [](Options& o) { o.set = Enclosed{.labels = Field::kPart}; }, client::Enclosed{},
       "--labels part: needs part among --fields"},
      {"enclosed.priority", [](Options& o) { o.set = Enclosed{.priority = {1}}; }, client::Enclosed{},
       "--priority: needs --labels"},
      {"fraction_labels",
       [](Options& o) { o.fraction_labels = {1}; },
       {},
       "--fraction-labels: needs label_fractions among --fields"},
      {"fraction_labels",
       [](Options& o) {
         o.fields = {Field::kLabelFractions};
         o.fraction_n = 4;
       },
       {},
       "--fields label_fractions: needs a solid with --labels"},
  };
}

std::vector<Case> Cases() {
  return {
      {"separability", [](Options& o) { o.separability = 3; }, {}, "--separability 3 exceeds 2"},
      {"fraction_labels",
       [](Options& o) {
         o.set = Enclosed{.labels = Field::kPart};
         o.fields = {Field::kPart, Field::kLabelFractions};
         o.fraction_n = 4;
       },
       client::Enclosed{},
       "--fields label_fractions: not together with --set enclosed, whose triangles need not be closed"},
      {"interior_rule",
       [](Options& o) { o.interior_rule = InteriorRule::kParity; },
       {},
       "--rule parity: needs --signed, fraction among --fields, or one side of links"},
      {"region",
       [](Options& o) {
         o.region = IndexBox{{0, 0, 0}, {1, 0, 1}};
       },
       {},
       "--region 0 is not above --region's 0"},
      {"bounds",
       [](Options& o) {
         o.bounds = Bounds{{0, 0, 0}, {1, kNan, 1}};
       },
       {},
       "--bounds nan is not finite"},
      {"shard",
       [](Options& o) {
         o.shard = Shard{3, 3};
       },
       {},
       "--shard 3 is not below --shard 3"},
      {"band",
       [](Options& o) {
         o.set = Band{-1, true};
       },
       client::Band{}, "--band -1 is not a finite number above 0"},
      {"enclosed", [](Options& o) { o.set = Enclosed{.close = -1}; }, client::Enclosed{},
       "--close -1 is not a finite number from 0 on"},
      {"connected",
       [](Options& o) {
         o.set = Connected{.seed = {0, kNan, 0}};
       },
       client::Connected{}, "--seed nan is not finite"},
      {"signed_distance", [](Options& o) { o.signed_distance = true; }, {}, "--signed: needs distance among --fields"},
      {"fraction_n",
       [](Options& o) {
         o.fields = {Field::kFraction};
         o.fraction_n = 17;
       },
       {},
       "--fields 17 exceeds 16"},
  };
}

// The SDK's error, as it comes from the server.
absl::Status Received(const absl::Status& of_core) {
  const auto payload = [&](const char* url) { return std::string{of_core.GetPayload(url).value_or(absl::Cord())}; };
  absl::Status status(of_core.code(), of_core.message());
  client::SetErrorDetails({"BAD_SPEC", payload(kRefusedField), payload(kRefusedValue), payload(kRefusedLimit),
                           std::nullopt, payload(kRefusedOther)},
                          status);
  return status;
}

client::VoxelizeRequest RequestOf(const client::VoxelSet& set) {
  client::VoxelizeRequest request;
  request.set = set;
  return request;
}

// Names that only the protocol has: those with _, and those of messages within the request, such as "solid.rule".
void AddNames(const google::protobuf::Descriptor& message, const std::string& prefix, std::set<std::string>& names) {
  for (int n = 0; n < message.field_count(); ++n) {
    const google::protobuf::FieldDescriptor& field = *message.field(n);
    if (absl::StrContains(field.name(), '_')) names.insert(field.name());
    if (!prefix.empty()) names.insert(absl::StrCat(prefix, ".", field.name()));
    const google::protobuf::Descriptor* const inner = field.message_type();
    if (inner != nullptr && prefix.empty()) AddNames(*inner, field.name(), names);
  }
}

TEST(OptionWords, TakeThePlaceOfFieldsInEveryRuleAboutOneOption) {
  std::set<std::string> rules, names;
  AddNames(*v1::VoxelizeSpec::descriptor(), "", names);
  EXPECT_TRUE(names.contains("solid.surface") && names.contains("fraction_n"));
  auto cases = Cases();
  for (const auto& of_labels : CasesOfLabels()) cases.push_back(of_labels);
  for (const auto& [rule, spoil, set, expected] : cases) {
    SCOPED_TRACE(rule);
    rules.insert(rule);
    Options options;
    spoil(options);
    const absl::Status told = client::WithOptions(Received(CheckRules(options)), RequestOf(set));
    EXPECT_EQ(told.message(), expected);
    EXPECT_TRUE(absl::StartsWith(client::GetErrorDetails(told).field, "--")) << client::GetErrorDetails(told).field;
    for (const absl::string_view word : absl::StrSplit(told.message(), absl::ByAnyChar(" :;,"))) {
      EXPECT_FALSE(names.contains(std::string(word))) << word;
    }
  }
  for (const ValueRule& rule : ValueRules()) EXPECT_TRUE(rules.contains(std::string(rule.option))) << rule.option;
}

// Returns what the tool says where the server says `text` of a request for this set.
std::string Told(const std::string& text, const client::VoxelSet& set = {}) {
  return std::string(client::WithOptions(absl::InvalidArgumentError(text), RequestOf(set)).message());
}

TEST(OptionWords, NameTheSetThatTheUserKnows) {
  const client::Solid interior{.surface = client::SolidSurface::kNone};
  EXPECT_EQ(Told("separability 2: not together with solid.surface none, which has no voxels of the surface", interior),
            "--separability 2: not together with --set interior, which has no voxels of the surface");
  EXPECT_EQ(Told("verify: not together with enclosed", client::Enclosed{.surface = client::SolidSurface::kNone}),
            "--verify: not together with --set enclosed-interior");
  EXPECT_EQ(Told("connected: not together with algorithm incremental", client::Connected{}),
            "--set region: not together with --algorithm incremental");
}

TEST(OptionWords, StandInErrorsThatDependOnTheMesh) {
  EXPECT_EQ(Told("connected.seed: the walk gets outside; connected.close may close it, and connected.allow_outside "
                 "allows it"),
            "--seed: the walk gets outside; --close may close it, and --allow-outside allows it");
  EXPECT_EQ(Told("mesh: it is not closed, and 4 lattice lines along k end unbalanced; force_open fills the others"),
            "mesh: it is not closed, and 4 lattice lines along k end unbalanced; --force-open fills the others");
  EXPECT_EQ(Told("solid.labels part: the mesh has more than 65536 labels"),
            "--labels part: the mesh has more than 65536 labels");
  EXPECT_EQ(Told("resolution: the mesh is a single point; give voxel_size"),
            "--resolution: the mesh is a single point; give --voxel-size");
}

TEST(OptionWords, LeaveOtherWordsAlone) {
  for (const char* const text :
       {"mesh: 4 links of band.obj have minimal fields", "the server closed. The region is up."}) {
    EXPECT_EQ(Told(text), text);
  }
  const absl::Status unavailable = absl::UnavailableError("fields: no");
  EXPECT_EQ(client::WithOptions(unavailable, {}), unavailable);
}

}  // namespace
}  // namespace latvox
