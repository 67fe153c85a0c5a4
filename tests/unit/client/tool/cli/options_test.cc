// The command line: the meaning of options, and refusals.
#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "client/internal/vec3.h"
#include "latvox/stretched.h"
#include "tests/unit/client/tool/cli/parsed.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Options, DefaultsAreThoseOfTheContract) {
  const VoxelizeOptions options = Parse({"--resolution", "64"});
  EXPECT_THAT(options.mesh.paths, ElementsAre("mesh.obj"));
  EXPECT_THAT(options.outputs, ElementsAre("out.vdb"));
  EXPECT_EQ(std::get<NamedLattice>(options.request.lattice), NamedLattice::kCartesian);
  EXPECT_EQ(options.request.resolution, 64u);
  EXPECT_EQ(options.request.voxel_size, std::nullopt);
  EXPECT_EQ(options.request.origin, std::nullopt);
  EXPECT_EQ(options.request.separability, 0u);
  EXPECT_EQ(options.request.minimal, std::nullopt);
  EXPECT_FALSE(options.request.verify || options.json);
  EXPECT_EQ(options.request.algorithm, Algorithm::kExact);
  EXPECT_EQ(options.quantization_bits, std::nullopt);
  EXPECT_EQ(options.server.address, "");
}

TEST(Options, EveryOptionArrivesWhereItBelongs) {
  const VoxelizeOptions options = Parse({"--basis",
                                         "1,0,0,-0.5,2,0,1e-1,.25,+3",
                                         "--voxel-size=0.125",
                                         "--origin",
                                         "-1,-2.5,3",
                                         "--separability",
                                         "2",
                                         "--no-minimal",
                                         "--region",
                                         "-1,-2,-3,4,5,6",
                                         "--bounds",
                                         "-0.5,1,2,.5,1,1e3",
                                         "--quantization",
                                         "0",
                                         "--json",
                                         "--threads",
                                         "3",
                                         "--timeout",
                                         "1.5",
                                         "--retries",
                                         "7",
                                         "-o",
                                         "b.csv",
                                         "--out",
                                         "c.png",
                                         "-o",
                                         "d.npy",
                                         "--algorithm",
                                         "optimized-incremental",
                                         "--set",
                                         "surface",
                                         "--up-axis",
                                         "y",
                                         "--scale",
                                         "2.5",
                                         "--input-format",
                                         "3mf",
                                         "--weld-report",
                                         "--npy",
                                         "dense"});
  EXPECT_EQ(std::get<Basis>(options.request.lattice), (Basis{{1, 0, 0}, {-0.5, 2, 0}, {0.1, 0.25, 3}}));
  EXPECT_EQ(options.request.voxel_size, 0.125);
  EXPECT_EQ(options.request.origin, (Vec3d{-1, -2.5, 3}));
  EXPECT_EQ(options.request.separability, 2u);
  EXPECT_EQ(options.request.minimal, false);
  EXPECT_EQ(options.request.region, (IndexBox{{-1, -2, -3}, {4, 5, 6}}));
  EXPECT_EQ(options.request.bounds, (WorldBox{{-0.5, 1, 2}, {0.5, 1, 1000}}));
  EXPECT_EQ(options.quantization_bits, 0);
  EXPECT_EQ(options.request.algorithm, Algorithm::kOptimizedIncremental);
  EXPECT_TRUE(options.json);
  EXPECT_EQ(options.mesh.up, UpAxis::kY);
  EXPECT_EQ(options.mesh.scale, 2.5);
  EXPECT_EQ(options.mesh.format, MeshFormat::kThreeMf);
  EXPECT_TRUE(options.weld_report && options.output_options.dense_npy);
  EXPECT_EQ(options.server.threads, 3);
  EXPECT_EQ(options.server.timeout_seconds, 1.5);
  EXPECT_EQ(options.server.retries, 7);
  EXPECT_THAT(options.outputs, ElementsAre("out.vdb", "b.csv", "c.png", "d.npy"));
}

TEST(Options, ThreeVoxelSizesStretchTheLattice) {
  const VoxelizeRequest cubes = Parse({"--voxel-size", "0.5,2,3", "--separability", "26"}).request;
  EXPECT_EQ(std::get<Basis>(cubes.lattice), (Basis{{0.5, 0, 0}, {0, 2, 0}, {0, 0, 3}}));
  EXPECT_EQ(cubes.voxel_size, std::nullopt);
  EXPECT_EQ(cubes.separability, 0u);
  const VoxelizeRequest same = Parse({"--voxel-size", "2,2,2", "--lattice", "fcc"}).request;
  EXPECT_EQ(std::get<NamedLattice>(same.lattice), NamedLattice::kFcc);
  EXPECT_EQ(same.voxel_size, 2);
  for (const auto& [name, lattice] : {std::pair("bcc", NamedLattice::kBcc), std::pair("fcc", NamedLattice::kFcc),
                                      std::pair("hexagonal", NamedLattice::kHexagonal)}) {
    const VoxelizeRequest request = Parse({"--voxel-size", "1,2,3", "--lattice", name}).request;
    const Basis& basis = std::get<Basis>(request.lattice);
    EXPECT_EQ(basis, Stretched(lattice, {1, 2, 3}));
    EXPECT_NEAR(std::abs(Dot(basis.a, Cross(basis.b, basis.c))), 6, 1e-14) << name;
  }
}

TEST(Options, OfASolidSayWhatIsInside) {
  const auto set = [](std::vector<std::string> words) {
    words.insert(words.end(), {"--resolution", "9"});
    return Parse(words).request.set;
  };
  EXPECT_EQ(set({}), VoxelSet(Surface{}));
  EXPECT_EQ(set({"--set", "surface"}), VoxelSet(Surface{}));
  EXPECT_EQ(set({"--set", "solid"}), VoxelSet(Solid{}));
  EXPECT_EQ(set({"--set", "solid", "--rule", "auto"}), VoxelSet(Solid{}));
  EXPECT_EQ(set({"--set", "solid", "--rule", "parity"}), VoxelSet(Solid{.rule = InteriorRule::kParity}));
  EXPECT_EQ(set({"--set", "solid", "--rule", "winding"}), VoxelSet(Solid{.rule = InteriorRule::kWinding}));
  EXPECT_EQ(set({"--set", "interior"}), VoxelSet(Solid{.surface = SolidSurface::kNone}));
  EXPECT_EQ(set({"--set", "supercover-solid"}), VoxelSet(Solid{.surface = SolidSurface::kSupercover}));
  EXPECT_EQ(set({"--set", "solid", "--force-open"}), VoxelSet(Solid{.force_open = true}));
}

TEST(Options, TheRuleIsForWhateverDependsOnTheInside) {
  const auto parse = [](std::vector<std::string> words) {
    words.insert(words.end(), {"--resolution", "9"});
    return Parse(words).request;
  };
  const std::vector<std::vector<std::string>> needs = {{"--band", "2v", "--signed"},
                                                       {"--fields", "fraction:4"},
                                                       {"--set", "links", "--side", "inside"},
                                                       {"--set", "enclosed", "--fields", "distance", "--signed"}};
  for (std::vector<std::string> words : needs) {
    EXPECT_EQ(parse(words).interior_rule, InteriorRule::kAuto);
    words.insert(words.end(), {"--rule", "positive"});
    EXPECT_EQ(parse(words).interior_rule, InteriorRule::kPositive);
  }
  EXPECT_EQ(parse({"--set", "solid", "--fields", "distance", "--signed", "--rule", "parity"}).interior_rule,
            InteriorRule::kAuto);
  for (const char* set : {"surface", "enclosed", "links"}) {
    Refuses({"--resolution", "9", "--set", set, "--rule", "parity"}, {"--rule: needs --set solid", "--signed"});
  }
}

TEST(Options, LabelsAreAFieldAndPrioritiesNumbersOrNames) {
  const auto parse = [](std::vector<std::string> words) {
    words.insert(words.end(), {"--resolution", "9", "--set", "interior"});
    return Parse(words);
  };
  const auto labeled = [](Field field, std::vector<uint32_t> priority) {
    return VoxelSet(Solid{.surface = SolidSurface::kNone, .labels = field, .priority = std::move(priority)});
  };
  const VoxelizeOptions labels = parse({"--labels", "material", "--fields", "part"});
  EXPECT_EQ(labels.request.set, labeled(Field::kMaterial, {}));
  EXPECT_THAT(labels.request.fields, ElementsAre(Field::kPart, Field::kMaterial));
  EXPECT_EQ(labels.mesh.attributes, labels.request.fields);
  EXPECT_EQ(parse({"--fields", "part,normal", "--priority", "3,0"}).request.set, labeled(Field::kPart, {3, 0}));
  EXPECT_THAT(parse({"--fields", "part", "--priority", "3,0"}).priority, ElementsAre());
  const VoxelizeOptions names = parse({"--fields", "part", "--priority", "3,lid"});
  EXPECT_EQ(names.request.set, labeled(Field::kPart, {}));
  EXPECT_THAT(names.priority, ElementsAre("3", "lid"));
  EXPECT_EQ(names.output_options.note.priority, names.priority);
}

TEST(Options, EnclosedSetsHaveLabelsAndPriorities) {
  const std::vector<std::string> set = {"--resolution", "9", "--set", "enclosed"};
  const auto with = [&set](std::vector<std::string> words) {
    words.insert(words.end(), set.begin(), set.end());
    return words;
  };
  const VoxelizeOptions numbers = Parse(with({"--labels", "material", "--priority", "2,0"}));
  EXPECT_EQ(numbers.request.set, VoxelSet(Enclosed{.labels = Field::kMaterial, .priority = {2, 0}}));
  EXPECT_THAT(numbers.request.fields, ElementsAre(Field::kMaterial));
  const VoxelizeOptions names = Parse(with({"--fields", "part", "--priority", "lid,0", "--close", "2"}));
  EXPECT_EQ(names.request.set, VoxelSet(Enclosed{.close = 2, .labels = Field::kPart}));
  EXPECT_EQ(Parse(with({"--close", "0"})).request.set, VoxelSet(Enclosed{}));
  for (const char* close : {"-1", "x", "nan", "inf"}) {
    EXPECT_THAT(Refusal(with({"--close", close})), HasSubstr("is not a finite number, at least 0"));
  }
  EXPECT_THAT(names.priority, ElementsAre("lid", "0"));
  Refuses(with({"--priority", "2"}), {"--priority", "needs --labels part or material"});
  Refuses({"--resolution", "9", "--set", "region", "--seed", "1,1,1", "--labels", "part", "--priority", "2"},
          {"--labels: needs --set solid", "enclosed-interior", "not region"});
}

TEST(Options, ThreeMfAsksForThePositiveRule) {
  const auto rule = [](const std::vector<std::string>& words) {
    VoxelizeWords given;
    CommandParser parser;
    AddVoxelizeOptions(parser, given);
    std::vector<std::string> all = {"--resolution", "9", "--set", "solid", "-o", "o.vdb"};
    all.insert(all.end(), words.begin(), words.end());
    parser.Parse(all);
    return std::get<Solid>(InterpretRequest(given).request.set).rule;
  };
  EXPECT_EQ(rule({"a.3mf"}), InteriorRule::kPositive);
  EXPECT_EQ(rule({"a.3MF", "b.3mf"}), InteriorRule::kPositive);
  EXPECT_EQ(rule({"a.bin", "--input-format", "3mf"}), InteriorRule::kPositive);
  EXPECT_EQ(rule({"a.3mf", "b.obj"}), InteriorRule::kAuto);
  EXPECT_EQ(rule({"a.3mf", "--input-format", "obj"}), InteriorRule::kAuto);
  EXPECT_EQ(rule({"a.3mf", "--rule", "auto"}), InteriorRule::kAuto);
}

TEST(Options, PlacementIsLeftToTheServerUnlessGiven) {
  EXPECT_EQ(Parse({"--resolution", "9", "--set", "solid"}).request.placement, std::nullopt);
  EXPECT_EQ(Parse({"--resolution", "9", "--placement", "points"}).request.placement, Placement::kPoints);
  EXPECT_EQ(Parse({"--resolution", "9", "--placement", "cells"}).request.placement, Placement::kCells);
}

TEST(Options, ASupercoverIsNotMinimal) {
  const VoxelizeRequest request = Parse({"--resolution", "9", "--set", "supercover"}).request;
  EXPECT_EQ(request.set, VoxelSet(Supercover{}));
  EXPECT_EQ(request.minimal, std::nullopt);
  EXPECT_EQ(Parse({"--resolution", "9", "--set", "supercover", "--no-minimal"}).request.minimal, false);
}

TEST(Options, MinimalMaySayWhether) {
  EXPECT_EQ(Parse({"--resolution", "9", "--minimal=true"}).request.minimal, true);
  EXPECT_EQ(Parse({"--resolution", "9", "--minimal=false"}).request.minimal, false);
  EXPECT_EQ(Parse({"--resolution", "9", "--no-minimal"}).request.minimal, false);
  EXPECT_THAT(Refusal({"--resolution", "9", "--minimal=1"}), HasSubstr("--minimal"));
}

TEST(Options, APrivateServerThatDiesIsNotAskedAgain) {
  ServerChoice choice;
  EXPECT_EQ(MakeCallOptions(choice, {}).retry.max_retries, 0);
  choice.address = "a:1,b:2";
  EXPECT_EQ(MakeCallOptions(choice, {}).retry.max_retries, RetryPolicy().max_retries);
  choice.retries = 7;
  EXPECT_EQ(MakeCallOptions(choice, {}).retry.max_retries, 7);
}

TEST(Options, NeighborCountsNameSeparabilitiesOnTheCartesianLatticeOnly) {
  EXPECT_EQ(Parse({"--resolution", "9", "--separability", "26"}).request.separability, 0u);
  EXPECT_EQ(Parse({"--resolution", "9", "--separability", "18"}).request.separability, 1u);
  EXPECT_EQ(Parse({"--resolution", "9", "--separability", "6"}).request.separability, 2u);
  EXPECT_THAT(Refusal({"--resolution", "9", "--separability", "6", "--lattice", "fcc"}),
              HasSubstr("--separability: 6"));
}

TEST(Options, ANamedLatticeHasADefaultResolutionAndABasisHasItsOwnDensity) {
  const VoxelizeOptions bcc = Parse({"--lattice", "bcc"}), basis = Parse({"--basis", "1,0,0,0,1,0,0,0,1"});
  EXPECT_EQ(bcc.request.resolution, 256u);
  EXPECT_TRUE(bcc.has_default_resolution);
  EXPECT_EQ(basis.request.resolution, std::nullopt);
  EXPECT_EQ(Parse({"--voxel-size", "2"}).request.resolution, std::nullopt);
  EXPECT_FALSE(basis.has_default_resolution || Parse({"--resolution", "256"}).has_default_resolution);
}

TEST(Options, FurtherNamesAndUpperCaseAreAccepted) {
  const VoxelizeOptions options = Parse({"--lattice", "BCC", "--res", "64", "--output", "b.csv"});
  EXPECT_EQ(std::get<NamedLattice>(options.request.lattice), NamedLattice::kBcc);
  EXPECT_EQ(options.request.resolution, 64u);
  EXPECT_THAT(options.outputs, ElementsAre("out.vdb", "b.csv"));
}

TEST(Options, AMissingArgumentAndAWrongServerAreToldInTheWordsOfHelp) {
  EXPECT_EQ(RefusalOfAll({"voxelize"}), "MESH is required");
  EXPECT_EQ(RefusalOfAll({"voxelize", ""}), "MESH: \"\" names no file");
  Refuses({"--server", "a:1,localhost"}, {"--server: \"localhost\" has no port; it is HOST:PORT or unix:PATH"});
  Refuses({"--server", "a:1", "--tls-cert", "c.pem"}, {"--tls-cert requires --tls-key"});
}

TEST(Options, TheFirstUnknownWordIsToldBeforeAMissingOneWithTheNearestKnownOne) {
  const std::pair<std::vector<std::string>, const char*> cases[] = {
      {{"voxelize", "--resolutoin", "9"}, "unknown option \"--resolutoin\"; did you mean --resolution?"},
      {{"voxelize", "-resolution", "9"}, "unknown option \"-resolution\"; did you mean --resolution?"},
      {{"voxelize", "--Voxel_Size=1", "a"}, "unknown option \"--Voxel_Size\"; did you mean --voxel-size?"},
      {{"voxelize", "a", "--qqq", "--resolutoin", "9"}, "unknown option \"--qqq\"; see latvox voxelize --help"},
      {{"voxelze", "a"}, "unknown command \"voxelze\"; did you mean voxelize?"},
      {{"voxelze", "--help"}, "unknown command \"voxelze\"; did you mean voxelize?"},
      {{"paint", "a"}, "unknown command \"paint\"; see latvox --help"},
      {{"view", "a", "b"}, "unexpected argument \"a\"; see latvox view --help"},
      {{"--resolution", "9", "voxelize"},
       "\"--resolution\" stands before the command; options follow it, see latvox voxelize --help"}};
  for (const auto& [words, text] : cases) EXPECT_EQ(RefusalOfAll(words), text);
}

TEST(Options, RefusalsOfLatticesNameOptionValueAndLimit) {
  Refuses({"--resolution", "0"}, {"--resolution", "\"0\"", "2 to 65536"});
  Refuses({"--resolution", "70000"}, {"--resolution", "70000", "65536"});
  Refuses({"--resolution", "-5"}, {"--resolution", "-5"});
  Refuses({"--resolution", "8.5"}, {"--resolution", "8.5"});
  Refuses({"--resolution", "8", "--voxel-size", "1"}, {"--resolution", "--voxel-size"});
  Refuses({"--voxel-size", "0"}, {"--voxel-size", "above 0"});
  Refuses({"--voxel-size", "1,2"}, {"--voxel-size", "one or three finite numbers"});
  Refuses({"--voxel-size", "1,2,-3"}, {"--voxel-size", "above 0"});
  Refuses({"--voxel-size", "1,2,3", "--basis", "1,0,0,0,1,0,0,0,1"}, {"--voxel-size", "--basis", "1,2,3"});
  Refuses({"--voxel-size", "inf"}, {"--voxel-size", "inf"});
  Refuses({"--voxel-size", "1e999"}, {"--voxel-size", "1e999"});
  Refuses({"--resolution", "9", "--separability", "5"}, {"--separability", "5", "0, 1, 2, 26, 18, 6"});
  Refuses({"--resolution", "9", "--lattice", "cubic"}, {"--lattice", "cubic", "hexagonal"});
  Refuses({"--lattice", "bcc", "--basis", "1,0,0,0,1,0,0,0,1"}, {"--basis", "--lattice"});
  Refuses({"--basis", "1,0,0,0,1,0,0,0"}, {"--basis", "9 finite numbers"});
  Refuses({"--basis", "1,0,0,0,1,0,0,0,nan"}, {"--basis", "9 finite numbers"});
  Refuses({"--resolution", "9", "--origin", "1,2"}, {"--origin", "3 finite numbers"});
}

TEST(Options, RefusalsOfPartsNameOptionValueAndLimit) {
  Refuses({"--resolution", "9", "--region", "0,0,0,0,1,1"}, {"--region", "lattice axis i"});
  Refuses({"--resolution", "9", "--region", "0,0,0,9999999999,1,1"}, {"--region", "32-bit"});
  Refuses({"--resolution", "9", "--bounds", "0,2,0,1,1,1"}, {"--bounds", "1 is below 2 on axis y"});
  Refuses({"--resolution", "9", "--bounds", "0,0,0,1,inf,1"}, {"--bounds", "6 finite numbers"});
  Refuses({"--resolution", "9", "--quantization", "31"}, {"--quantization", "31", "30"});
}

TEST(Options, RefusalsOfSetsNameOptionValueAndLimit) {
  Refuses({"--resolution", "9", "--algorithm", "ibanez"}, {"--algorithm", "ibanez", "exact", "optimized-incremental"});
  Refuses({"--resolution", "9", "--set", "hollow"}, {"--set", "hollow", "solid", "surface", "band"});
  Refuses({"--resolution", "9", "--set", "solid", "--rule", "odd"}, {"--rule", "odd", "parity"});
  Refuses({"--resolution", "9", "--rule", "winding"}, {"--rule", "--set solid", "surface"});
  Refuses({"--resolution", "9", "--set", "band"}, {"--set", "band", "--band W"});
  Refuses({"--resolution", "9", "--set", "solid", "--band", "2v"}, {"--band", "--set band", "solid"});
  Refuses({"--resolution", "9", "--band", "2v", "--npy", "dense", "-o", "a.npy", "--fields", "distance,part"},
          {"--fields", "a.npy", "cannot hold distance,part", "--array selects"});
  Refuses({"--resolution", "9", "--fields", "part,shape"}, {"--fields", "shape", "part", "normal"});
  Refuses({"--resolution", "9", "--fields", "part,part"}, {"--fields", "part", "twice"});
  for (const char* field : {"triangle", "point", "normal", "link_triangles"}) {
    Refuses({"--resolution", "9", "--fields", field, "--upload", "draco"}, {"--fields", field, "--upload raw"});
  }
  Refuses({"--align", "a.vdb", "--separability", "26"}, {"--separability", "26", "--lattice cartesian"});
  Refuses({"--resolution", "9", "--set", "surface", "--force-open"}, {"--force-open", "--set solid"});
  Refuses({"--resolution", "9", "--labels", "part"}, {"--labels", "--set solid"});
  Refuses({"--resolution", "9", "--priority", "1"}, {"--priority", "--set solid"});
  Refuses({"--resolution", "9", "--set", "solid", "--priority", "1"}, {"--priority", "--labels"});
  Refuses({"--resolution", "9", "--set", "solid", "--priority", "1", "--fields", "part,material"}, {"both"});
  Refuses({"--resolution", "9", "--set", "solid", "--labels", "part", "--priority", "1,,2"}, {"--priority", "empty"});
  Refuses({"--resolution", "9", "--set", "solid", "--labels", "color"}, {"--labels", "color", "material"});
  EXPECT_EQ(Refusal({"--resolution", "9", "--no-minimal", "--algorithm", "incremental"}), "accepted");
  EXPECT_EQ(Parse({"--resolution", "9", "--no-minimal", "--minimal"}).request.minimal, true);  // the last one counts
  EXPECT_EQ(Parse({"--resolution", "9", "--minimal", "--no-minimal"}).request.minimal, false);
}

TEST(Options, RefusalsOfRunsNameOptionValueAndLimit) {
  Refuses({"--resolution", "9", "--threads", "0"}, {"--threads", "\"0\""});
  Refuses({"--resolution", "9", "--timeout", "-1"}, {"--timeout", "-1"});
  Refuses({"--resolution", "9", "--retries", "-1"}, {"--retries", "-1"});
  Refuses({"--resolution", "9", "--threads", "2", "--server", "x:1"}, {"--threads", "--server"});
  Refuses({"--resolution", "9", "--frobnicate"}, {"--frobnicate"});
}

TEST(Options, ABandIsInWorldUnitsOrInVoxels) {
  const VoxelizeRequest world = Parse({"--resolution", "9", "--band", "0.25"}).request;
  EXPECT_EQ(world.set, VoxelSet(Band{.width = 0.25}));
  EXPECT_THAT(world.fields, ElementsAre(Field::kDistance));
  EXPECT_FALSE(world.signed_distance);
  const VoxelizeRequest voxels = Parse({"--resolution", "9", "--set", "band", "--band", "3v", "--signed"}).request;
  EXPECT_EQ(voxels.set, VoxelSet(Band{.width = 3, .in_voxels = true}));
  EXPECT_TRUE(voxels.signed_distance);
  EXPECT_THAT(Parse({"--resolution", "9", "--band", "1", "--fields", "normal"}).request.fields,
              ElementsAre(Field::kNormal));
  for (const char* width : {"0", "-1", "v", "3V", "1e999", "nan"}) {
    EXPECT_THAT(Refusal({"--resolution", "9", "--band", width}), HasSubstr("is not a finite number above 0"));
  }
  EXPECT_THAT(Refusal({"--resolution", "9", "--signed"}), AllOf(HasSubstr("--signed"), HasSubstr("--fields distance")));
  for (const char* output : {"a.glb", "a.binvox", "a.vox"}) {
    EXPECT_THAT(
        Refusal({"--resolution", "9", "--band", "1", "-o", output}),
        HasSubstr(std::string(output) + " cannot hold distance; .vdb .nvdb .csv .npy .npz .ply .png .html .vti .vtu "
                                        ".cells.vtu .h5 "
                                        ".nrrd .mha .mhd .nii .nii.gz can"));
  }
}

}  // namespace
}  // namespace latvox::client
