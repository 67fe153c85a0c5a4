// The rules of a request: the options that each one refuses, and its message.
#include "core/request/rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/base/status_payload.h"
#include "core/request/grid_request.h"
#include "core/request/request.h"

namespace latvox {
namespace {

using testing::HasSubstr;

std::string Payload(const absl::Status& status, const char* url) {
  return std::string{status.GetPayload(url).value_or(absl::Cord())};
}

// Message, field, value and limit of an error of MakeRequest.
std::vector<std::string> RefusalOf(const VoxelizeOptions& options) {
  const absl::Status status = MakeRequest(options).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  return {std::string{status.message()}, Payload(status, kRefusedField), Payload(status, kRefusedValue),
          Payload(status, kRefusedLimit)};
}

TEST(Rules, NameFieldValueAndLimitOfAValue) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(RefusalOf({.separability = 3}), (Words{"separability 3 exceeds 2", "separability", "3", "2"}));
  EXPECT_EQ(RefusalOf({.separability = -1}), (Words{"separability -1 is below 0", "separability", "-1", "0"}));
  EXPECT_EQ(RefusalOf({.region = IndexBox{{0, 4, 0}, {9, 4, 9}}}),
            (Words{"region.max.j 4 is not above region.min's 4", "region.max.j", "4", "4"}));
  EXPECT_EQ(RefusalOf({.bounds = Bounds{{0, 0, 0}, {1, INFINITY, 1}}}),
            (Words{"bounds.max.y inf is not finite", "bounds.max.y", "inf", ""}));
  EXPECT_EQ(RefusalOf({.bounds = Bounds{{0, 0, 2}, {1, 1, 1}}}),
            (Words{"bounds.max.z 1 is below bounds.min's 2", "bounds.max.z", "1", "2"}));
  EXPECT_EQ(RefusalOf({.shard = Shard{0, 0}}),
            (Words{"shard.count 0 is not within 1 to 1048576", "shard.count", "0", "1048576"}));
  EXPECT_EQ(RefusalOf({.shard = Shard{3, 3}}),
            (Words{"shard.index 3 is not below shard.count 3", "shard.index", "3", "2"}));
  EXPECT_EQ(RefusalOf({.set = Band{0, true}}),
            (Words{"band.voxels 0 is not a finite number above 0", "band.voxels", "0", "0"}));
  EXPECT_EQ(RefusalOf({.set = Band{NAN, false}}),
            (Words{"band.width nan is not a finite number above 0", "band.width", "nan", "0"}));
  EXPECT_EQ(RefusalOf({.fields = {Field::kNormal}, .signed_distance = true}),
            (Words{"signed_distance true: needs distance among fields", "signed_distance", "true", ""}));
}

TEST(Rules, OfTheInsideAskForSomethingThatDependsOnIt) {
  using Words = std::vector<std::string>;
  constexpr InteriorRule kRule = InteriorRule::kParity;
  const Words needless{"interior_rule parity: needs signed_distance, fraction among fields, or one side of links",
                       "interior_rule", "parity", ""};
  EXPECT_EQ(RefusalOf({.fields = {Field::kDistance}, .interior_rule = kRule}), needless);
  EXPECT_EQ(RefusalOf({.set = Links{}, .interior_rule = kRule}), needless);
  EXPECT_EQ(RefusalOf({.set = Solid{}, .interior_rule = kRule}),
            (Words{"interior_rule parity: not together with solid, which has a rule of its own", "interior_rule",
                   "parity", ""}));
  const auto rule = [](const VoxelizeOptions& options) { return MakeRequest(options)->interior_rule; };
  EXPECT_EQ(rule({.set = Links{LinkSide::kInside}, .interior_rule = kRule}), kRule);
  EXPECT_EQ(rule({.fields = {Field::kDistance}, .signed_distance = true, .interior_rule = kRule}), kRule);
  EXPECT_EQ(rule({.fields = {Field::kFraction}, .interior_rule = kRule, .fraction_n = 2}), kRule);
  EXPECT_EQ(rule({.set = Solid{.rule = kRule}}), kRule);
}

TEST(Rules, OfFractionsAskForTheirFieldAndANumberOfPoints) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(RefusalOf({.fields = {Field::kPart}, .fraction_n = 8}),
            (Words{"fraction_n 8: needs fraction or label_fractions among fields", "fraction_n", "8", ""}));
  EXPECT_EQ(RefusalOf({.fields = {Field::kFraction}}), (Words{"fraction_n 0 is below 2", "fraction_n", "0", "2"}));
  EXPECT_EQ(RefusalOf({.fields = {Field::kFraction}, .fraction_n = 17}),
            (Words{"fraction_n 17 exceeds 16", "fraction_n", "17", "16"}));
  EXPECT_TRUE(MakeRequest({.fields = {Field::kFraction}, .fraction_n = 16}).ok());
}

TEST(Rules, OfLabelsAskForTheirFieldAndForEachLabelOnce) {
  using Words = std::vector<std::string>;
  const auto refusal = [](std::optional<Field> labels, std::vector<uint32_t> priority) {
    return RefusalOf(
        {.set = Solid{.labels = labels, .priority = std::move(priority)}, .fields = {Field::kPart, Field::kColor}});
  };
  EXPECT_EQ(refusal(Field::kColor, {}),
            (Words{"solid.labels color is neither part nor material", "solid.labels", "color", ""}));
  EXPECT_EQ(refusal(Field::kMaterial, {}),
            (Words{"solid.labels material: needs material among fields", "solid.labels", "material", ""}));
  EXPECT_EQ(refusal(std::nullopt, {1}), (Words{"solid.priority: needs solid.labels", "solid.priority", "", ""}));
  EXPECT_EQ(refusal(Field::kPart, {4, 1, 4}), (Words{"solid.priority 4 occurs twice", "solid.priority", "4", ""}));
  EXPECT_EQ(refusal(Field::kPart, {0x80000000}),
            (Words{"solid.priority 2147483648 exceeds 2147483647", "solid.priority", "2147483648", "2147483647"}));
  EXPECT_EQ(refusal(Field::kPart, std::vector<uint32_t>(kMaxLabels + 1)),
            (Words{"solid.priority: 65537 labels exceed 65536", "solid.priority", "65537", "65536"}));
}

TEST(Rules, OfLabelsOfEnclosedSetsAreThoseOfSolids) {
  using Words = std::vector<std::string>;
  const auto refusal = [](std::optional<Field> labels, std::vector<uint32_t> priority) {
    return RefusalOf({.set = Enclosed{.labels = labels, .priority = std::move(priority)}, .fields = {Field::kPart}});
  };
  EXPECT_EQ(refusal(Field::kMaterial, {}),
            (Words{"enclosed.labels material: needs material among fields", "enclosed.labels", "material", ""}));
  EXPECT_EQ(refusal(std::nullopt, {1}),
            (Words{"enclosed.priority: needs enclosed.labels", "enclosed.priority", "", ""}));
  EXPECT_EQ(refusal(Field::kPart, {4, 1, 4}),
            (Words{"enclosed.priority 4 occurs twice", "enclosed.priority", "4", ""}));
  EXPECT_TRUE(MakeRequest({.set = Enclosed{.labels = Field::kPart}, .fields = {Field::kPart}})->labels().has_value());
}

TEST(Rules, SayWhichTwoOptionsDoNotGoTogether) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(RefusalOf({.minimal = true, .set = SupercoverSurface{}}),
            (Words{"minimal: not together with supercover, which is not thinned", "minimal", "", ""}));
  EXPECT_EQ(RefusalOf({.minimal = true, .set = Solid{.surface = SolidSurface::kSupercover}}),
            (Words{"minimal: not together with solid.surface supercover, which is not thinned", "minimal", "", ""}));
  EXPECT_EQ(RefusalOf({.algorithm = Algorithm::kBruteForce, .fields = {Field::kPart}}),
            (Words{"fields: not together with algorithm brute-force", "fields", "", ""}));
  EXPECT_EQ(RefusalOf({.separability = 2, .set = Solid{.surface = SolidSurface::kNone}}),
            (Words{"separability 2: not together with solid.surface none, which has no voxels of the surface",
                   "separability", "2", ""}));
  EXPECT_EQ(RefusalOf({.minimal = true, .set = Links{}}),
            (Words{"minimal: not together with links, which is not thinned", "minimal", "", ""}));
}

// Links depend on it, whatever the set.
TEST(Rules, AllowSeparabilityForEverySetWithFieldsOfLinks) {
  for (const SetOption& set : {SetOption{Band{1, true}}, SetOption{Solid{.surface = SolidSurface::kNone}}}) {
    EXPECT_FALSE(MakeRequest({.separability = 1, .set = set}).ok());
    EXPECT_TRUE(MakeRequest({.separability = 1, .set = set, .fields = {Field::kLinkCrossings}}).ok());
  }
}

TEST(Rules, JudgeWalks) {
  using Words = std::vector<std::string>;
  EXPECT_EQ(RefusalOf({.set = Enclosed{.surface = SolidSurface::kSupercover}}),
            (Words{"enclosed.surface supercover: is not separating or none", "enclosed.surface", "supercover", ""}));
  EXPECT_EQ(RefusalOf({.set = Enclosed{.close = -1}}),
            (Words{"enclosed.close -1 is not a finite number from 0 on", "enclosed.close", "-1", "0"}));
  EXPECT_EQ(RefusalOf({.set = Connected{.seed = {0, INFINITY, 0}}}),
            (Words{"connected.seed.y inf is not finite", "connected.seed.y", "inf", ""}));
  const VoxelRequest enclosed = *MakeRequest({.separability = 2, .set = Enclosed{.surface = SolidSurface::kNone}});
  EXPECT_TRUE(enclosed.walk() != nullptr && enclosed.is_minimal() && !enclosed.has_surface());
  EXPECT_EQ(NameOfSet(enclosed), "enclosed-interior");
  const VoxelRequest region = *MakeRequest({.minimal = false, .set = Connected{.seed = {1, 2, 3}}});
  EXPECT_TRUE(region.walk()->seed == (Vec3d{1, 2, 3}) && !region.is_minimal() && region.is_filled());
  EXPECT_EQ(NameOfSet(region), "region");
}

TEST(Rules, EachExclusionStandsOnceAndNamesTwoOptions) {
  std::vector<std::pair<std::string_view, std::string_view>> pairs;
  for (const Exclusion& rule : Exclusions()) {
    EXPECT_NE(rule.option, rule.other);
    pairs.emplace_back(std::min(rule.option, rule.other), std::max(rule.option, rule.other));
  }
  std::ranges::sort(pairs);
  EXPECT_EQ(std::ranges::adjacent_find(pairs), pairs.end());
}

TEST(Rules, StandInTheContractsPageAsTheyAre) {
  std::string table = "| option | other | reason |\n|---|---|---|\n";
  const auto words = [](std::string_view name) { return std::ranges::find(Options(), name, &Option::name)->words; };
  for (const Exclusion& rule : Exclusions()) {
    const std::string_view why = rule.why.starts_with(", ") ? rule.why.substr(2) : rule.why;
    table += "| " + std::string{words(rule.option)} + " | " + std::string{words(rule.other)} + " | " +
             std::string{why} + " |\n";
  }
  std::ostringstream page;
  page << std::ifstream(LATVOX_PROTO_README).rdbuf();
  EXPECT_THAT(page.str(), HasSubstr(table));
}

TEST(MakeRequest, ThinsWhereverThatIsPossible) {
  const auto is_minimal = [](const VoxelizeOptions& options) { return MakeRequest(options)->is_minimal(); };
  EXPECT_TRUE(is_minimal({}));
  EXPECT_TRUE(is_minimal({.minimal = true}));
  EXPECT_TRUE(is_minimal({.set = Solid{}}));
  EXPECT_FALSE(is_minimal({.minimal = false}));
  EXPECT_FALSE(is_minimal({.algorithm = Algorithm::kIncremental}));
  EXPECT_FALSE(is_minimal({.set = SupercoverSurface{}}));
  EXPECT_FALSE(is_minimal({.set = Band{1, true}}));
}

TEST(MakeRequest, PutsEachSetIntoItsAlternative) {
  const VoxelRequest surface = *MakeRequest({.algorithm = Algorithm::kBruteForce});
  EXPECT_TRUE(surface.surface() != nullptr && surface.solid() == nullptr && surface.band() == nullptr);
  EXPECT_EQ(surface.algorithm(), Algorithm::kBruteForce);
  const VoxelRequest solid = *MakeRequest({.set = Solid{.surface = SolidSurface::kSupercover, .force_open = true}});
  EXPECT_TRUE(solid.surface() != nullptr && solid.solid() != nullptr && solid.band() == nullptr);
  EXPECT_TRUE(solid.solid()->force_open && solid.is_supercover());
  const VoxelRequest band = *MakeRequest({.set = Band{2, true}, .fields = {Field::kDistance}, .signed_distance = true});
  EXPECT_TRUE(band.surface() == nullptr && band.solid() == nullptr && band.band() != nullptr);
  EXPECT_TRUE(band.signed_distance);
  EXPECT_EQ(band.algorithm(), Algorithm::kExact);
  const VoxelRequest links = *MakeRequest({.separability = 1, .set = Links{LinkSide::kOutside}});
  EXPECT_TRUE(links.surface() == nullptr && links.solid() == nullptr && links.band() == nullptr);
  EXPECT_EQ(links.links()->side, LinkSide::kOutside);
  EXPECT_FALSE(links.is_minimal());
}

TEST(MakeGridRequest, WantsASamplingOfANamedLatticeAlone) {
  const Mat3d basis{{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}};
  EXPECT_THAT(std::string{MakeGridRequest({NamedLattice::kBcc, {}, {}}).status().message()},
              HasSubstr("sampling: a named lattice needs voxel_size or resolution"));
  EXPECT_TRUE(MakeGridRequest({NamedLattice::kBcc, {.resolution = 9}, {}}).ok());
  const auto unscaled = MakeGridRequest({basis, {}, {}});
  ASSERT_TRUE(unscaled.ok());
  EXPECT_DOUBLE_EQ(unscaled->lattice.voxel_size(), 2);
  const absl::Status singular = MakeGridRequest({Mat3d{}, {}, {}}).status();
  EXPECT_EQ(singular.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(Payload(singular, kRefusedField), "lattice.basis");
}

}  // namespace
}  // namespace latvox
