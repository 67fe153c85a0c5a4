// Job files and their lines.
#include <gmock/gmock.h>

#include <algorithm>
#include <map>

#include "client/tool/cli/file_url.h"
#include "client/tool/cli/job_file.h"
#include "client/tool/cli/job_line.h"
#include "client/tool/cli/request_rows.h"
#include "client/tool/cli/worker.h"
#include "deploy/manual/command_parser.h"
#include "latvox/error.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

absl::StatusOr<Job> Parse(const std::string& line) { return JobParser("jobs", "out").Parse(line); }

std::string Refusal(const std::string& line) {
  const auto job = Parse(line);
  return job.ok() ? "accepted" : std::string(job.status().message());
}

TEST(JobLine, DefaultsAreThoseOfVoxelize) {
  const auto job = Parse(R"({"mesh": "a/b.stl", "resolution": 64})");
  ASSERT_TRUE(job.ok()) << job.status();
  EXPECT_EQ(job->id, "b.vdb");
  EXPECT_EQ(job->mesh, "a/b.stl");
  EXPECT_THAT(job->names, ElementsAre("b.vdb"));
  EXPECT_EQ(job->options.mesh.paths[0], "jobs/a/b.stl");
  EXPECT_THAT(job->options.outputs, ElementsAre("out/b.vdb"));
  EXPECT_EQ(job->options.request.resolution, 64u);
  EXPECT_EQ(std::get<NamedLattice>(job->options.request.lattice), NamedLattice::kCartesian);
  EXPECT_EQ(job->options.request.minimal, std::nullopt);
  EXPECT_EQ(job->options.quantization_bits, std::nullopt);
}

TEST(JobLine, EveryFieldArrivesWhereItBelongs) {
  const auto job =
      Parse(R"({"id": "x", "mesh": "/m.obj", "out": ["d/./a.vdb", "b.csv"], "basis": [1,0,0,-0.5,2,0,1e-1,0.25,3],
    "voxel_size": 0.1, "origin": [-1, -2.5, 3], "separability": 2, "minimal": false, "algorithm": "incremental",
    "set": "surface", "fields": ["part", "normal"], "quantization": 0, "region": [-1,-2,-3,4,5,6], "bounds": [0,0,0,0.5,1,2],
    "verify": false,
    "encoding": "masks"})");
  ASSERT_TRUE(job.ok()) << job.status();
  EXPECT_EQ(job->id, "x");
  EXPECT_THAT(job->names, ElementsAre("d/a.vdb", "b.csv"));
  EXPECT_EQ(job->options.mesh.paths[0], "/m.obj");
  EXPECT_THAT(job->options.outputs, ElementsAre("out/d/a.vdb", "out/b.csv"));
  const VoxelizeRequest& request = job->options.request;
  EXPECT_EQ(std::get<Basis>(request.lattice), (Basis{{1, 0, 0}, {-0.5, 2, 0}, {0.1, 0.25, 3}}));
  EXPECT_EQ(request.voxel_size, 0.1);
  EXPECT_EQ(request.origin, (Vec3d{-1, -2.5, 3}));
  EXPECT_EQ(request.separability, 2u);
  EXPECT_EQ(request.minimal, false);
  EXPECT_FALSE(request.verify);
  EXPECT_EQ(request.algorithm, Algorithm::kIncremental);
  EXPECT_EQ(request.region, (IndexBox{{-1, -2, -3}, {4, 5, 6}}));
  EXPECT_EQ(request.bounds, (WorldBox{{0, 0, 0}, {0.5, 1, 2}}));
  EXPECT_EQ(request.encoding, BrickEncoding::kMasks);
  EXPECT_EQ(job->options.quantization_bits, 0);
  EXPECT_EQ(Parse(R"({"mesh": "m", "resolution": 9, "set": "interior", "rule": "winding",
    "force_open": true})")
                ->options.request.set,
            VoxelSet(Solid{InteriorRule::kWinding, SolidSurface::kNone, true}));
  const auto labeled = Parse(R"({"mesh": "m", "resolution": 9, "set": "solid", "labels": "part", "priority": [4, 2]})");
  ASSERT_TRUE(labeled.ok()) << labeled.status();
  EXPECT_EQ(labeled->options.request.set, VoxelSet(Solid{.labels = Field::kPart, .priority = {4, 2}}));
  EXPECT_THAT(Parse(R"({"mesh": "m", "resolution": 9, "set": "solid", "labels": "part", "priority": [4, "lid"]})")
                  ->options.priority,
              ElementsAre("4", "lid"));
  EXPECT_THAT(request.fields, ElementsAre(Field::kPart, Field::kNormal));
  EXPECT_TRUE(
      Parse(R"({"mesh": "m", "resolution": 9, "verify": true, "quantization": "auto"})")->options.request.verify);
}

TEST(JobLine, SeveralMeshesAreOneJob) {
  const auto job = Parse(R"({"mesh": ["a/b.stl", "-", "file:///c.obj"], "resolution": 64})");
  ASSERT_TRUE(job.ok()) << job.status();
  EXPECT_THAT(job->options.mesh.paths, ElementsAre("jobs/a/b.stl", "jobs/-", "/c.obj"));
  EXPECT_EQ(job->mesh, "a/b.stl + - + file:///c.obj");
  EXPECT_THAT(job->names, ElementsAre("b.vdb"));
}

TEST(JobLine, AVoxelSizeIsANumberOrThreeAndAlignAPath) {
  const auto job = Parse(R"({"mesh": "m", "voxel_size": [1, 0.5, 2]})");
  ASSERT_TRUE(job.ok()) << job.status();
  EXPECT_EQ(std::get<Basis>(job->options.request.lattice), (Basis{{1, 0, 0}, {0, 0.5, 0}, {0, 0, 2}}));
  EXPECT_EQ(Parse(R"({"mesh": "m", "align": "a/g.vdb"})")->options.align, "jobs/a/g.vdb");
  EXPECT_EQ(Parse(R"({"mesh": "m", "align": "file:///g.vdb"})")->options.align, "/g.vdb");
  EXPECT_EQ(Parse(R"({"mesh": "m", "resolution": 9})")->options.align, "");
}

TEST(JobLine, ABandIsANumberOrAText) {
  const auto world = Parse(R"({"mesh": "m", "resolution": 9, "band": 0.5, "signed": true})");
  ASSERT_TRUE(world.ok()) << world.status();
  EXPECT_EQ(world->options.request.set, VoxelSet(Band{.width = 0.5}));
  EXPECT_TRUE(world->options.request.signed_distance);
  const auto voxels = Parse(R"({"mesh": "m", "resolution": 9, "band": "3v"})");
  ASSERT_TRUE(voxels.ok()) << voxels.status();
  EXPECT_EQ(voxels->options.request.set, VoxelSet(Band{.width = 3, .in_voxels = true}));
  EXPECT_FALSE(voxels->options.request.signed_distance);
  EXPECT_THAT(voxels->options.request.fields, ElementsAre(Field::kDistance));
}

TEST(JobLine, EveryOptionOfARequestHasItsField) {
  CommandParser parser;
  VoxelizeWords words;
  AddRequestOptions(parser, words);
  int fields = 0;
  for (const OptionState& option : parser.States()) {
    std::string field = option.name;
    if (field == "help" || field == "out") continue;
    std::replace(field.begin(), field.end(), '-', '_');
    EXPECT_THAT(Refusal("{\"mesh\": \"m\", \"" + field + "\": null}"), StartsWith(field + ": null is not "));
    ++fields;
  }
  EXPECT_GT(fields, 10);
}

TEST(JobLine, AParserForgetsTheLineBefore) {
  JobParser parser("", "out");
  ASSERT_TRUE(
      parser.Parse(R"({"mesh": "m", "resolution": 9, "minimal": false, "origin": [1,2,3], "lattice": "fcc"})").ok());
  EXPECT_FALSE(parser.Parse(R"({"mesh": "m", "resolution": 1, "verify": true})").ok());
  const auto job = parser.Parse(R"({"mesh": "m", "voxel_size": 2})");
  ASSERT_TRUE(job.ok()) << job.status();
  const VoxelizeRequest& request = job->options.request;
  EXPECT_TRUE(!request.minimal && !request.verify && !request.origin && !request.resolution);
  EXPECT_EQ(std::get<NamedLattice>(request.lattice), NamedLattice::kCartesian);
  EXPECT_THAT(job->options.outputs, ElementsAre("out/m.vdb"));
}

TEST(JobLine, RefusalsNameFieldValueAndLimit) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {R"("resolution": 70000)", "resolution: \"70000\" is not a whole number from 2 to 65536"},
      {R"("resolution": 8.5)", "resolution: \"8.5\" is not a whole number"},
      {R"("fields": "fraction:17")", "fields: \"fraction:17\": 17 is not a whole number from 2 to 16"},
      {R"("resolution": "8")", "resolution: \"8\" is not a number"},
      {R"("resolution": 8, "voxel_size": 1)", "voxel_size excludes resolution"},
      {R"("resolution": 8, "resolution": 9)", "resolution: is given twice"},
      {R"("resolutoin": 8)", "resolutoin: unknown field; did you mean resolution?"},
      {R"("frobnicate": 8)", "frobnicate: unknown field; the fields are mesh, out, id, lattice, "},
      {R"("voxel_size": [1, 2])", "voxel_size: \"1,2\" is not one or three finite numbers above 0"},
      {R"("voxel_size": "1")", "voxel_size: \"1\" is not a number or an array of numbers"},
      {R"("align": "g.vdb", "resolution": 8)", "resolution excludes align"},
      {R"("align": 5)", "align: 5 is not a non-empty string"},
      {R"("voxel_size": -1)", "voxel_size: \"-1\" is not a finite number above 0"},
      {R"("voxel_size": 1e999)", "not JSON: "},
      {R"("lattice": "cubic", "resolution": 8)", R"(lattice: "cubic" is not one of cartesian, bcc, fcc, hexagonal)"},
      {R"("lattice": "", "resolution": 8)", "lattice: \"\" is not a non-empty string"},
      {R"("lattice": "--json", "resolution": 8)", "lattice: \"--json\" is not one of"},
      {R"("basis": [1,0,0,0,1,0,0,0])", "basis: \"1,0,0,0,1,0,0,0\" is not 9 finite numbers"},
      {R"("basis": [[1,0,0],[0,1,0],[0,0,1]])", "arrays and objects cannot be nested within a field"},
      {R"("basis": "1,0,0,0,1,0,0,0,1")", "basis: \"1,0,0,0,1,0,0,0,1\" is not an array of numbers"},
      {R"("origin": [1,2,"3"], "resolution": 8)", "origin: [1,2,\"3\"] is not an array of numbers"},
      {R"("minimal": 1, "resolution": 8)", "minimal: 1 is not true or false"},
      {R"("region": [0,0,0,0,1,1], "resolution": 8)", "region: \"0,0,0,0,1,1\" is empty"},
      {R"("quantization": 31, "resolution": 8)",
       "quantization: \"31\" is neither auto nor a whole number from 0 to 30"},
      {R"("shard": "3/3", "resolution": 8)", "shard: \"3/3\" is not I/N with 0 <= I < N"},
      {R"("id": "", "resolution": 8)", "id: \"\" is not a non-empty string"},
      {R"("id": null, "resolution": 8)", "id: null is not a non-empty string"},
      {R"("out": [], "resolution": 8)", "out: [] is not a file name"},
      {R"("out": 5, "resolution": 8)", "out: 5 is not a file name"},
      {R"("out": "a.xyz", "resolution": 8)", "out: \"a.xyz\": extension \".xyz\" is not one of .vdb"},
      {R"("out": "a/../../b.vdb", "resolution": 8)", "out: \"a/../../b.vdb\" is not a file below the output directory"},
      {R"("out": "/b.vdb", "resolution": 8)", "out: \"/b.vdb\" is not a file below the output directory"},
      {R"("out": "a/", "resolution": 8)", "out: \"a/\" is not a file below the output directory"},
      {R"("out": "a\u0000.vdb", "resolution": 8)", "out: \"a\\u0000.vdb\" is not a file below the output directory"},
  };
  for (const auto& [fields, says] : cases) {
    EXPECT_THAT(Refusal("{\"mesh\": \"m.obj\", " + fields + "}"), StartsWith(says));
  }
  EXPECT_THAT(Refusal(R"({"resolution": 8})"), StartsWith("mesh: null is not a path"));
  EXPECT_THAT(Refusal(R"({"mesh": [], "resolution": 8})"), StartsWith("mesh: [] is not a path"));
  EXPECT_THAT(Refusal(R"({"mesh": ["m", 3], "resolution": 8})"), StartsWith("mesh: [\"m\",3] is not a path"));
  EXPECT_THAT(Refusal("[1]"), StartsWith("[1] is not a JSON object"));
  EXPECT_THAT(Refusal("# comment"), StartsWith("not JSON: column 1: "));
  EXPECT_THAT(Refusal(R"({"mesh": "m.obj", "resolution": 8} x)"), StartsWith("not JSON: column 36: "));
  EXPECT_THAT(Refusal(std::string(100000, '[') + std::string(100000, ']')), StartsWith("arrays and objects"));
  EXPECT_LT(Refusal("[\"" + std::string(100000, 'x') + "\"]").size(), 200u);
}

TEST(JobLine, ErrorsOfTheJobNameFieldsInPlaceOfOptions) {
  absl::Status error = absl::InvalidArgumentError("--separability 2: not together with --set interior, at --server");
  SetErrorDetails({"BAD_SPEC", "--separability", "2", "", std::nullopt, "--set"}, error);
  const absl::Status told = JobParser("", "").WithFields(error);
  EXPECT_EQ(told.message(), "separability 2: not together with set interior, at --server");
  EXPECT_EQ(GetErrorDetails(told).field, "separability");
  EXPECT_EQ(GetErrorDetails(told).other, "set");
}

TEST(FileUrl, PathsAndUrlsLeadToTheSameFile) {
  const std::map<std::string, std::string> paths = {{"a/b.obj", "jobs/a/b.obj"},
                                                    {"/a/b.obj", "/a/b.obj"},
                                                    {"a:b.obj", "jobs/a:b.obj"},
                                                    {"a%20b.obj", "jobs/a%20b.obj"},
                                                    {"file:///a/b%20c%2Fd.obj", "/a/b c/d.obj"},
                                                    {"file://localhost/a.obj", "/a.obj"},
                                                    {"FILE:/a.obj", "/a.obj"}};
  for (const auto& [text, path] : paths) {
    const auto found = PathOf(text, "jobs");
    ASSERT_TRUE(found.ok()) << found.status();
    EXPECT_EQ(*found, path);
  }
  for (const char* text : {"s3://a/b.obj", "https://a/b.obj", "file://elsewhere/a.obj", "file:a.obj", "file:///a%2.obj",
                           "file:///a%zz.obj", "file:///a%00.obj", "file:///a%"}) {
    EXPECT_THAT(std::string(PathOf(text, "jobs").status().message()), StartsWith("\"" + std::string(text) + "\": "));
  }
}

class JobFileTest : public FilesTest {
 protected:
  std::string PlacesOf(const std::string& fields) const {
    const auto job = JobParser(Path(""), Path("")).Parse("{" + fields + R"(, "resolution": 8})");
    EXPECT_TRUE(job.ok()) << job.status();
    return job.ok() ? std::string(CheckPlaces(*job).message()) : "";
  }

  JobFile ReadJobs(const std::string& text, const Worker& worker = {}) const {
    auto file = ReadJobFile(Write("jobs.jsonl", text), Path("out"), worker, Cancellation());
    EXPECT_TRUE(file.ok()) << file.status();
    return file.ok() ? *std::move(file) : JobFile();
  }
};

TEST_F(JobFileTest, BlankLinesAreNoJobsAndLinesKeepTheirNumbers) {
  const std::string job = R"({"resolution": 8, "mesh": )";
  const JobFile file = ReadJobs("\n" + job + "\"a\"}\r\n  \t\n" + job + "\"b\"}");
  EXPECT_EQ(file.wrong, 0u) << file.errors.front();
  EXPECT_EQ(file.jobs, 2u);
  ASSERT_EQ(file.lines.size(), 2u);
  EXPECT_EQ(file.lines[0].number, 2u);
  EXPECT_EQ(file.lines[1].number, 4u);
  EXPECT_EQ(file.lines[1].text, job + "\"b\"}");
}

TEST_F(JobFileTest, WorkersShareTheJobsEvenly) {
  std::string text;
  for (int n = 0; n < 100; ++n)
    text += "{\"mesh\": \"" + std::to_string(n) + ".obj\", \"resolution\": 8}\n" + std::string(n % 3, '\n');
  const JobFile whole = ReadJobs(text);
  for (const uint32_t count : {1u, 2u, 7u, 100u, 101u}) {
    std::set<uint64_t> seen;
    for (uint32_t index = 0; index < count; ++index) {
      const JobFile part = ReadJobs(text, {index, count});
      EXPECT_EQ(part.jobs, 100u);
      EXPECT_LE(part.lines.size(), 100 / count + 1);
      EXPECT_GE(part.lines.size(), 100 / count);
      for (const JobLine& line : part.lines) EXPECT_TRUE(seen.insert(line.number).second);
    }
    EXPECT_EQ(seen.size(), 100u);
  }
}

TEST_F(JobFileTest, EveryWrongLineIsNamedWhosesoeverItIs) {
  const JobFile file = ReadJobs(R"({"mesh": "a", "resolution": 1}
{"mesh": "b", "resolution": 8, "id": "x"}
{"mesh": "d/b", "resolution": 8}
{"mesh": "c", "resolution": 8, "id": "x"}
{"mesh": "out/e.ply", "resolution": 8}
{"mesh": "f", "resolution": 8, "out": "e.ply"}
{"mesh": "g", "resolution": 8, "out": ["g.vdb", "./g.vdb"]}
{"mesh": "out/h.ply", "resolution": 8, "out": "h.ply"}
{"mesh": "i", "align": "out/b.vdb"}
)",
                                {1, 3});
  const std::string path = Path("jobs.jsonl");
  EXPECT_EQ(file.wrong, 7u);
  EXPECT_THAT(file.errors, ElementsAre(StartsWith(path + ":1: resolution: \"1\""),
                                       path + ":3: out: \"b.vdb\" is already used by line 2",
                                       path + ":4: id: \"x\" is already used by line 2",
                                       path + ":7: out: \"g.vdb\" is already used by line 7",
                                       AllOf(StartsWith(path + ":5: mesh: "), HasSubstr("an output of line 6")),
                                       AllOf(StartsWith(path + ":8: mesh: "), HasSubstr("an output of line 8")),
                                       AllOf(StartsWith(path + ":9: align: "), HasSubstr("an output of line 2"))));
}

TEST_F(JobFileTest, LinksLeadNoOutputToTheMeshOrAnotherOutput) {
  Write("m.ply", "mesh");
  std::filesystem::create_symlink(Path("m.ply"), Path("m.obj"));
  std::filesystem::create_directory_symlink(Path(""), Path("same"));
  EXPECT_THAT(PlacesOf(R"("mesh": "m.obj", "out": "m.ply")"), HasSubstr("is the mesh itself"));
  EXPECT_THAT(PlacesOf(R"("mesh": "m.obj", "out": ["a.vdb", "same/a.vdb"])"), HasSubstr("is given twice"));
  EXPECT_EQ(PlacesOf(R"("mesh": "m.obj", "out": ["a.vdb", "b.vdb"])"), "");
}

TEST_F(JobFileTest, OnlyTheFirstOfManyWrongLinesAreKept) {
  std::string text;
  for (int n = 0; n < 1000; ++n) text += "{}\n";
  const JobFile file = ReadJobs(text);
  EXPECT_EQ(file.wrong, 1000u);
  EXPECT_EQ(file.errors.size(), 20u);
}

TEST_F(JobFileTest, ReadingStopsWhenItIsCancelled) {
  const Cancellation cancellation;
  cancellation.Cancel();
  EXPECT_EQ(ReadJobFile(Write("j", "{}\n"), Path("out"), {}, cancellation).status().code(),
            absl::StatusCode::kCancelled);
}

TEST_F(JobFileTest, AFileWithoutAJobIsAnError) {
  const auto read = [&](const std::string& path) {
    return ReadJobFile(path, Path("out"), {}, Cancellation()).status();
  };
  EXPECT_EQ(read(Path("missing")).code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(read(Path("")).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(read(Write("blank", " \n\n")).message()), HasSubstr("contains no job"));
}

}  // namespace
}  // namespace latvox::client
