// The command line: what options mean, how the tool ends.
#include <gmock/gmock.h>
#include <signal.h>

#include <CLI/CLI.hpp>

#include "client/cli/exit_status.h"
#include "client/cli/private_server.h"
#include "client/cli/progress_bar.h"
#include "client/cli/report.h"
#include "client/cli/voxelize_command.h"
#include "client/cli/voxelize_options.h"
#include "client/error.h"
#include "client/output/vec3.h"
#include "client/stretched.h"
#include "tests/unit/client_files.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// Parses as the tool does. Throws what it throws.
VoxelizeOptions Parse(std::vector<std::string> arguments) {
  CLI::App app;
  VoxelizeWords words;
  AddVoxelizeOptions(app, words);
  arguments.insert(arguments.begin(), {"mesh.obj", "-o", "out.vdb"});
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants vectors
  app.parse(arguments);
  return Interpret(words);
}

std::string Refusal(const std::vector<std::string>& arguments) {
  try {
    Parse(arguments);
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Options, DefaultsAreThoseOfTheContract) {
  const VoxelizeOptions options = Parse({"--resolution", "64"});
  EXPECT_THAT(options.mesh.paths, ElementsAre("mesh.obj"));
  EXPECT_THAT(options.outputs, ElementsAre("out.vdb"));
  EXPECT_EQ(std::get<NamedLattice>(options.request.lattice), NamedLattice::kCartesian);
  EXPECT_EQ(options.request.resolution, 64u);
  EXPECT_EQ(options.request.voxel_size, std::nullopt);
  EXPECT_EQ(options.request.origin, std::nullopt);
  EXPECT_EQ(options.request.separability, 0u);
  EXPECT_TRUE(options.request.minimal);
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
                                         "--fill",
                                         "surface",
                                         "--up",
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
  EXPECT_FALSE(options.request.minimal);
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
  EXPECT_EQ(Parse({"--resolution", "9"}).request.solid, std::nullopt);
  EXPECT_EQ(Parse({"--resolution", "9", "--fill", "surface"}).request.solid, std::nullopt);
  EXPECT_EQ(Parse({"--resolution", "9", "--fill", "solid"}).request.solid, Solid{});
  EXPECT_EQ(Parse({"--resolution", "9", "--fill", "solid", "--interior-rule", "parity"}).request.solid, Solid{});
  EXPECT_EQ(Parse({"--resolution", "9", "--fill", "solid", "--interior-rule", "winding"}).request.solid,
            (Solid{.rule = InteriorRule::kWinding}));
  EXPECT_EQ(Parse({"--resolution", "9", "--fill", "solid", "--without-surface"}).request.solid,
            (Solid{.surface = false}));
  EXPECT_EQ(Parse({"--resolution", "9", "--fill", "solid", "--force-open"}).request.solid, (Solid{.force_open = true}));
}

TEST(Options, ASupercoverIsNotMinimal) {
  const VoxelizeRequest request = Parse({"--resolution", "9", "--cover", "supercover"}).request;
  EXPECT_EQ(request.cover, Cover::kSupercover);
  EXPECT_FALSE(request.minimal);
  EXPECT_FALSE(Parse({"--resolution", "9", "--cover", "supercover", "--no-minimal"}).request.minimal);
  EXPECT_EQ(Parse({"--resolution", "9"}).request.cover, Cover::kSeparating);
}

TEST(Options, APrivateServerThatDiesIsNotAskedAgain) {
  ServerChoice choice;
  EXPECT_EQ(MakeCallOptions(choice, {}).retry.max_retries, 0);
  choice.address = "a:1,b:2";
  EXPECT_EQ(MakeCallOptions(choice, {}).retry.max_retries, RetryPolicy().max_retries);
  choice.retries = 7;
  EXPECT_EQ(MakeCallOptions(choice, {}).retry.max_retries, 7);
}

TEST(Options, NeighbourCountsNameSeparabilitiesOnTheCartesianLatticeOnly) {
  EXPECT_EQ(Parse({"--resolution", "9", "--separability", "26"}).request.separability, 0u);
  EXPECT_EQ(Parse({"--resolution", "9", "--separability", "18"}).request.separability, 1u);
  EXPECT_EQ(Parse({"--resolution", "9", "--separability", "6"}).request.separability, 2u);
  EXPECT_THAT(Refusal({"--resolution", "9", "--separability", "6", "--lattice", "fcc"}),
              HasSubstr("--separability: 6"));
}

TEST(Options, ABasisNeedsNoDensityButANamedLatticeDoes) {
  EXPECT_NO_THROW(Parse({"--basis", "1,0,0,0,1,0,0,0,1"}));
  EXPECT_THAT(Refusal({"--lattice", "bcc"}), HasSubstr("--voxel-size or --resolution is required"));
}

TEST(Options, RefusalsNameOptionValueAndLimit) {
  const auto refuses = [](const std::vector<std::string>& arguments, const std::vector<std::string>& says) {
    for (const std::string& text : says) EXPECT_THAT(Refusal(arguments), HasSubstr(text));
  };
  refuses({"--resolution", "0"}, {"--resolution", "\"0\"", "2 to 65536"});
  refuses({"--resolution", "70000"}, {"--resolution", "70000", "65536"});
  refuses({"--resolution", "-5"}, {"--resolution", "-5"});
  refuses({"--resolution", "8.5"}, {"--resolution", "8.5"});
  refuses({"--resolution", "8", "--voxel-size", "1"}, {"--resolution", "--voxel-size"});
  refuses({"--voxel-size", "0"}, {"--voxel-size", "above 0"});
  refuses({"--voxel-size", "1,2"}, {"--voxel-size", "one number or three"});
  refuses({"--voxel-size", "1,2,-3"}, {"--voxel-size", "above 0"});
  refuses({"--voxel-size", "1,2,3", "--basis", "1,0,0,0,1,0,0,0,1"}, {"--voxel-size", "--basis", "1,2,3"});
  refuses({"--voxel-size", "inf"}, {"--voxel-size", "inf"});
  refuses({"--voxel-size", "1e999"}, {"--voxel-size", "1e999"});
  refuses({"--resolution", "9", "--separability", "5"}, {"--separability", "5", "0,1,2,26,18,6"});
  refuses({"--resolution", "9", "--lattice", "cubic"}, {"--lattice", "cubic", "hexagonal"});
  refuses({"--lattice", "bcc", "--basis", "1,0,0,0,1,0,0,0,1"}, {"--basis", "--lattice"});
  refuses({"--basis", "1,0,0,0,1,0,0,0"}, {"--basis", "9 finite numbers"});
  refuses({"--basis", "1,0,0,0,1,0,0,0,nan"}, {"--basis", "9 finite numbers"});
  refuses({"--resolution", "9", "--origin", "1,2"}, {"--origin", "3 finite numbers"});
  refuses({"--resolution", "9", "--region", "0,0,0,0,1,1"}, {"--region", "axis 0"});
  refuses({"--resolution", "9", "--region", "0,0,0,9999999999,1,1"}, {"--region", "32-bit"});
  refuses({"--resolution", "9", "--region", "0,0,0,1,1,1", "--verify"}, {"--region", "--verify"});
  refuses({"--resolution", "9", "--bounds", "0,2,0,1,1,1"}, {"--bounds", "1 is below 2 on axis 1"});
  refuses({"--resolution", "9", "--bounds", "0,0,0,1,inf,1"}, {"--bounds", "6 finite numbers"});
  refuses({"--resolution", "9", "--bounds", "0,0,0,1,1,1", "--verify"}, {"--bounds", "--verify"});
  refuses({"--resolution", "9", "--quantization", "31"}, {"--quantization", "31", "30"});
  refuses({"--resolution", "9", "--algorithm", "ibanez"}, {"--algorithm", "ibanez", "exact", "optimized-incremental"});
  refuses({"--resolution", "9", "--fill", "hollow"}, {"--fill", "hollow", "solid", "surface"});
  refuses({"--resolution", "9", "--fill", "solid", "--interior-rule", "odd"}, {"--interior-rule", "odd", "parity"});
  refuses({"--resolution", "9", "--fill", "solid", "--verify"}, {"--verify", "--fill"});
  refuses({"--resolution", "9", "--fill", "solid", "--algorithm", "incremental"}, {"--fill", "solid", "exact"});
  refuses({"--resolution", "9", "--interior-rule", "winding"}, {"--interior-rule", "--fill solid"});
  refuses({"--resolution", "9", "--without-surface"}, {"--without-surface", "--fill solid"});
  refuses({"--resolution", "9", "--fill", "surface", "--force-open"}, {"--force-open", "--fill solid"});
  refuses({"--resolution", "9", "--up", "w"}, {"--up", "w", "x,y"});
  refuses({"--resolution", "9", "--scale", "-1"}, {"--scale", "-1", "above 0"});
  refuses({"--resolution", "9", "--input-format", "fbx"}, {"--input-format", "fbx", "3mf"});
  refuses({"--resolution", "9", "--npy", "sparse"}, {"--npy", "sparse", "dense"});
  refuses({"--resolution", "9", "--npy", "dense"}, {"--npy", "dense", "--out"});
  refuses({"--resolution", "9", "-", "-"}, {"-", "twice"});
  refuses({"--resolution", "9", "--cover", "all"}, {"--cover", "all", "separating", "supercover"});
  refuses({"--resolution", "9", "--cover", "supercover", "--minimal"}, {"--minimal", "--cover supercover"});
  refuses({"--resolution", "9", "--cover", "supercover", "--algorithm", "incremental"},
          {"--cover supercover", "--algorithm incremental"});
  refuses({"--resolution", "9", "--minimal", "--algorithm", "incremental"}, {"--minimal", "--algorithm incremental"});
  for (const char* path : {"a.vox", "a.BINVOX"}) {
    refuses({"--resolution", "9", "--lattice", "bcc", "-o", path}, {"--out", path, "--lattice cartesian"});
    refuses({"--voxel-size", "1,1,2", "-o", path}, {"--out", path, "--lattice cartesian"});
    refuses({"--basis", "1,0,0,0,1,0,0,1,1", "-o", path}, {"--out", path, "--lattice cartesian"});
    EXPECT_EQ(Refusal({"--basis", "2,0,0,0,2,0,0,0,2", "-o", path}), "accepted");
  }
  EXPECT_EQ(Refusal({"--resolution", "9", "--no-minimal", "--algorithm", "incremental"}), "accepted");
  refuses({"--resolution", "9", "--threads", "0"}, {"--threads", "\"0\""});
  refuses({"--resolution", "9", "--timeout", "-1"}, {"--timeout", "-1"});
  refuses({"--resolution", "9", "--retries", "-1"}, {"--retries", "-1"});
  refuses({"--resolution", "9", "--threads", "2", "--server", "x:1"}, {"--threads", "--server"});
  refuses({"--resolution", "9", "-o", "a.xyz"}, {"a.xyz", ".vdb"});
  refuses({"--resolution", "9", "-o", "./out.vdb"}, {"out.vdb", "twice"});
  refuses({"--resolution", "9", "--frobnicate"}, {"--frobnicate"});
}

TEST(Options, ABandIsInWorldUnitsOrInVoxels) {
  const auto world = Parse({"--resolution", "9", "--band", "0.25"}).request.band;
  EXPECT_TRUE(world && world->width == 0.25 && !world->in_voxels && !world->is_signed);
  const auto voxels = Parse({"--resolution", "9", "--band", "3v", "--signed"}).request.band;
  EXPECT_TRUE(voxels && voxels->width == 3 && voxels->in_voxels && voxels->is_signed);
  EXPECT_FALSE(Parse({"--resolution", "9"}).request.band);
  for (const char* width : {"0", "-1", "v", "3V", "1e999", "nan"}) {
    EXPECT_THAT(Refusal({"--resolution", "9", "--band", width}), HasSubstr("is not a finite number above 0"));
  }
  EXPECT_THAT(Refusal({"--resolution", "9", "--signed"}), AllOf(HasSubstr("--signed"), HasSubstr("--band")));
  for (const auto& [other, value] :
       {std::pair{"--separability", "1"}, {"--algorithm", "exact"}, {"--fill", "surface"}, {"--cover", "separating"}}) {
    EXPECT_THAT(Refusal({"--resolution", "9", "--band", "1", other, value}),
                AllOf(HasSubstr("--band"), HasSubstr(other)));
  }
  EXPECT_THAT(Refusal({"--resolution", "9", "--band", "1", "--verify"}),
              AllOf(HasSubstr("--band"), HasSubstr("--verify")));
  for (const char* output : {"a.nvdb", "a.glb", "a.binvox", "a.vox"}) {
    EXPECT_THAT(Refusal({"--resolution", "9", "--band", "1", "-o", output}),
                HasSubstr(std::string(output) + " cannot hold distances; .vdb .csv .npy .ply .png can"));
  }
}

TEST(Exit, EveryStatusCodeHasItsNumber) {
  using absl::StatusCode;
  const std::map<StatusCode, int> numbers = {
      {StatusCode::kOk, 0},          {StatusCode::kInvalidArgument, 3},   {StatusCode::kNotFound, 3},
      {StatusCode::kUnavailable, 4}, {StatusCode::kResourceExhausted, 5}, {StatusCode::kUnauthenticated, 5},
      {StatusCode::kCancelled, 6},   {StatusCode::kDeadlineExceeded, 6}};
  for (int code = 0; code <= 16; ++code) {
    const auto status_code = static_cast<StatusCode>(code);
    const auto found = numbers.find(status_code);
    EXPECT_EQ(static_cast<int>(ExitStatusOf(absl::Status(status_code, ""))), found == numbers.end() ? 1 : found->second)
        << code;
  }
}

TEST(Exit, TheLineNamesFieldAndLimitOnceAndIsOneLine) {
  absl::Status status = absl::ResourceExhaustedError("too many\njobs: 5");
  SetErrorDetails({"JOBS", "jobs", "5", "4", absl::Seconds(2)}, status);
  EXPECT_EQ(ErrorText(status), "too many jobs: 5 (limit 4) (try again in 2s)");
}

TEST(Report, JsonHasEveryKeyThatScriptsRelyOn) {
  VoxelizeReport report;
  report.summary.certificate.lattice = "bcc";
  const std::string plain = ToJson(report);
  for (const char* key :
       {"voxels",     "bricks",      "lattice",  "basis",  "origin",    "voxel_size",     "separability",
        "digest",     "certificate", "minimal",  "cover",  "closed",    "snap_error_max", "verified",
        "timings_ms", "encode",      "upload",   "decode", "voxelize",  "stream",         "total",
        "bytes",      "sent",        "received", "mesh",   "triangles", "vertices"}) {
    EXPECT_THAT(plain, HasSubstr("\"" + std::string(key) + "\":"));
  }
  EXPECT_THAT(plain, HasSubstr("\"tunnels\": null"));
  EXPECT_THAT(plain, HasSubstr("\"redundant\": null"));
  report.summary.certificate.verified = true;
  EXPECT_THAT(ToJson(report), HasSubstr("\"tunnels\": 0"));
  report.outputs = {"not utf-8 \xFF.vdb"};
  EXPECT_THAT(ToJson(report), HasSubstr("not utf-8"));
}

TEST(Report, TellsOfABand) {
  VoxelizeReport report;
  EXPECT_THAT(ToJson(report), Not(HasSubstr("\"band\"")));
  report.summary.certificate.band = BandCertificate{0.5, true, "0123"};
  EXPECT_THAT(ToJson(report),
              AllOf(HasSubstr("\"width\": 0.5"), HasSubstr("\"signed\": true"), HasSubstr("\"digest\": \"0123\"")));
  EXPECT_THAT(ToText(report), HasSubstr("band of 0.5, signed"));
}

TEST(Report, TextClaimsNoSeparationThatIsNotCertain) {
  VoxelizeReport report;
  report.summary.certificate.algorithm = "incremental";
  report.summary.certificate.separability = 1;
  EXPECT_THAT(ToText(report), AllOf(HasSubstr("k = 1, incremental"), Not(HasSubstr("separating"))));
  report.summary.certificate.tunnel_free = true;
  EXPECT_THAT(ToText(report), AllOf(HasSubstr("1-separating"), Not(HasSubstr("minimal"))));
  report.summary.certificate.minimal = true;
  EXPECT_THAT(ToText(report), HasSubstr("1-separating, minimal"));
}

TEST(Progress, RatesAndTheTimeLeftAreToldOnceTheyMeanSomething) {
  EXPECT_EQ(CountText("bricks", 1000, absl::Milliseconds(100)), "1000 bricks");
  EXPECT_EQ(CountText("bricks", 1000, absl::Seconds(4)), "1000 bricks, 250/s");
  EXPECT_EQ(RemainingText(0.25, absl::Milliseconds(100)), "");
  EXPECT_EQ(RemainingText(0, absl::Seconds(4)), "");
  EXPECT_EQ(RemainingText(0.25, absl::Seconds(4)), ", 12s left");
  EXPECT_EQ(RemainingText(0.25, absl::Seconds(25)), ", 1m15s left");
  EXPECT_EQ(RemainingText(1, absl::Seconds(25)), ", 0 left");
}

TEST(Progress, TheBarShrinksFirstThenTheCountsAndTheTimeLeftIsLastToGo) {
  const auto line = [](size_t columns) {
    const ProgressLine fit = FitProgress(columns, 0.12, "voxelizing", "bricks", 1736221, absl::Milliseconds(542569));
    return absl::StrCat(fit.cells, fit.text);
  };
  const char* const kWhole = "  12 %  voxelizing: 1736221 bricks, 3200/s, 1h6m19s left";
  EXPECT_EQ(line(120), absl::StrCat(30, kWhole));
  EXPECT_EQ(line(80), absl::StrCat(80 - 3 - strlen(kWhole), kWhole));
  EXPECT_EQ(line(60), "4  12 %  voxelizing: 1h6m19s left, 1.7M bricks, 3200/s");
  EXPECT_EQ(line(40), "0  12 %  voxelizing: 1h6m19s left, 1.7");
}

TEST(Progress, ShortCountsHaveThreeDigitsOrSo) {
  const std::vector<std::pair<uint64_t, const char*>> counts = {
      {0, "0"},        {9999, "9999"},    {10000, "10K"},      {12345, "12.3K"},
      {99999, "100K"}, {1736221, "1.7M"}, {8800000000, "8.8G"}};
  for (const auto& [count, text] : counts) EXPECT_EQ(ShortNumber(count), text);
}

TEST(Report, SaysHowAMeshWasFilled) {
  VoxelizeReport report;
  EXPECT_THAT(ToText(report), Not(HasSubstr("filled")));
  EXPECT_THAT(ToJson(report), AllOf(HasSubstr("\"fill\": \"surface\""), Not(HasSubstr("unbalanced_lines"))));
  report.summary.certificate.solid = SolidFacts{"winding", false, 0};
  EXPECT_THAT(ToText(report),
              AllOf(HasSubstr("filled by winding, without the surface\n"), Not(HasSubstr("not filled"))));
  report.summary.certificate.solid->unbalanced_lines = 7;
  EXPECT_THAT(ToText(report), HasSubstr("not filled: 7 lattice lines"));
  EXPECT_THAT(ToJson(report), AllOf(HasSubstr("\"fill\": \"solid\""), HasSubstr("\"interior_rule\": \"winding\""),
                                    HasSubstr("\"with_surface\": false"), HasSubstr("\"unbalanced_lines\": 7")));
}

class Command : public FilesTest {};

TEST_F(Command, AServerThatCannotBeReachedLeavesNoFileAndKeepsOldOnes) {
  VoxelizeOptions options;
  options.mesh.paths = {Write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")};
  options.outputs = {Path("a.vdb"), Write("b.csv", "old")};
  options.request.resolution = 4;
  options.server.address = "unix:" + Path("nobody");
  const auto report = RunVoxelize(options, Cancellation());
  EXPECT_EQ(ExitStatusOf(report.status()), ExitStatus::kUnreachable);
  EXPECT_THAT(Names(), ElementsAre("b.csv", "m.obj"));
  EXPECT_EQ(Read("b.csv"), "old");
}

TEST_F(Command, ACancelledOneStopsBeforeTheServerIsNeeded) {
  VoxelizeOptions options;
  options.mesh.paths = {Write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")};
  options.outputs = {Path("a.vdb")};
  options.request.resolution = 4;
  options.server.address = "unix:" + Path("nobody");
  const Cancellation cancellation;
  cancellation.Cancel();
  EXPECT_EQ(ExitStatusOf(RunVoxelize(options, cancellation).status()), ExitStatus::kCancelled);
  EXPECT_THAT(Names(), ElementsAre("m.obj"));
}

// Puts a program in latvoxd's place, and the private directory where it can be seen.
class Private : public FilesTest {
 protected:
  void Be(const std::string& script) const {
    const std::string program = Write("fake", "#!/bin/sh\n" + script);
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    std::filesystem::create_directory(Path("run"));
    setenv("LATVOX_LATVOXD", program.c_str(), 1);
    setenv("XDG_RUNTIME_DIR", Path("run").c_str(), 1);
  }
  ~Private() override {
    unsetenv("LATVOX_LATVOXD");
    unsetenv("XDG_RUNTIME_DIR");
  }
};

TEST_F(Private, AServerThatEndsEarlyIsReportedAndItsDirectoryRemoved) {
  Be("exit 7\n");
  const auto server = PrivateServer::Start(std::nullopt, {});
  EXPECT_EQ(server.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(server.status().message()), HasSubstr("status 7"));
  EXPECT_TRUE(std::filesystem::is_empty(Path("run")));
}

TEST_F(Private, AProgramThatIsMissingIsReported) {
  Be("");
  setenv("LATVOX_LATVOXD", Path("missing").c_str(), 1);
  const auto server = PrivateServer::Start(std::nullopt, {});
  EXPECT_EQ(server.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(server.status().message()), HasSubstr("missing"));
  EXPECT_TRUE(std::filesystem::is_empty(Path("run")));
}

TEST_F(Private, OneThatNeverServesIsEndedAtTheDeadlineEvenIfItIgnoresSigterm) {
  Be("echo $$ \"$@\" > \"$0.words\"\ntrap '' TERM\nwhile :; do sleep 0.05; done\n");
  CallOptions options;
  options.deadline = absl::Now() + absl::Milliseconds(300);
  EXPECT_EQ(PrivateServer::Start(5, options).status().code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_TRUE(std::filesystem::is_empty(Path("run")));
  std::istringstream words(Read("fake.words"));
  pid_t pid = 0;
  words >> pid;
  EXPECT_NE(kill(pid, 0), 0);
  EXPECT_THAT(words.str(), HasSubstr("--listen unix:" + Path("run")));
  EXPECT_THAT(words.str(), HasSubstr("--exit-with-parent --log-level warning --threads 5"));
}

}  // namespace
}  // namespace latvox::client
