// The jobs of a worker, and resuming a batch.
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <future>
#include <map>

#include "absl/strings/str_replace.h"
#include "client/tool/cli/batch_options.h"
#include "client/tool/cli/batch_results.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/job_digest.h"
#include "client/tool/cli/worker.h"
#include "latvox/error.h"
#include "latvox/grid/voxel_grid.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// Clears the variables of engines from the environment.
class Workers : public testing::Test {
 protected:
  Workers() {
    for (const char* name : kNames) unsetenv(name);
  }
  ~Workers() override {
    for (const char* name : kNames) unsetenv(name);
  }
  static void Set(const std::map<std::string, std::string>& variables) {
    for (const char* name : kNames) unsetenv(name);
    for (const auto& [name, value] : variables) setenv(name.c_str(), value.c_str(), 1);
  }
  static std::string Refusal(const std::map<std::string, std::string>& variables) {
    Set(variables);
    try {
      ChooseWorker("");
    } catch (const UsageError& error) {
      return error.what();
    }
    return "accepted";
  }
  static constexpr const char* kNames[] = {"JOB_COMPLETION_INDEX",   "LATVOX_WORKER_COUNT",  "SLURM_ARRAY_TASK_ID",
                                           "SLURM_ARRAY_TASK_COUNT", "SLURM_ARRAY_TASK_MIN", "SLURM_ARRAY_TASK_STEP"};
};

TEST_F(Workers, WithoutAWordItIsTheWhole) {
  EXPECT_EQ(ChooseWorker("").worker, (Worker{0, 1}));
  EXPECT_EQ(ChooseWorker("").source, "");
}

TEST_F(Workers, TheOptionGoesBeforeTheEnvironment) {
  Set({{"JOB_COMPLETION_INDEX", "1"}});
  EXPECT_EQ(ChooseWorker("2/3").worker, (Worker{2, 3}));
  EXPECT_EQ(ChooseWorker("2/3").source, "--worker");
}

TEST_F(Workers, EnginesTellTheirs) {
  Set({{"JOB_COMPLETION_INDEX", "1"}, {"LATVOX_WORKER_COUNT", "4"}});
  EXPECT_EQ(ChooseWorker("").worker, (Worker{1, 4}));
  EXPECT_EQ(ChooseWorker("").source, "JOB_COMPLETION_INDEX, LATVOX_WORKER_COUNT");
  Set({{"SLURM_ARRAY_TASK_ID", "9"}, {"SLURM_ARRAY_TASK_COUNT", "4"}, {"SLURM_ARRAY_TASK_MIN", "8"}});
  EXPECT_EQ(ChooseWorker("").worker, (Worker{1, 4}));
  Set({{"SLURM_ARRAY_TASK_ID", "14"},
       {"SLURM_ARRAY_TASK_COUNT", "4"},
       {"SLURM_ARRAY_TASK_MIN", "8"},
       {"SLURM_ARRAY_TASK_STEP", "2"},
       {"JOB_COMPLETION_INDEX", ""}});
  EXPECT_EQ(ChooseWorker("").worker, (Worker{3, 4}));
  EXPECT_EQ(ChooseWorker("").source, "SLURM_ARRAY_TASK_ID, SLURM_ARRAY_TASK_COUNT");
}

TEST_F(Workers, WhatIsIncompleteOrOutOfRangeIsRefused) {
  EXPECT_THAT(Refusal({{"JOB_COMPLETION_INDEX", "1"}}), HasSubstr("LATVOX_WORKER_COUNT is not"));
  EXPECT_THAT(Refusal({{"LATVOX_WORKER_COUNT", "4"}}), HasSubstr("JOB_COMPLETION_INDEX is not"));
  EXPECT_THAT(Refusal({{"JOB_COMPLETION_INDEX", "4"}, {"LATVOX_WORKER_COUNT", "4"}}),
              HasSubstr("4 is not below the count, 4"));
  EXPECT_THAT(Refusal({{"JOB_COMPLETION_INDEX", "-1"}, {"LATVOX_WORKER_COUNT", "4"}}),
              HasSubstr("JOB_COMPLETION_INDEX: \"-1\""));
  EXPECT_THAT(Refusal({{"SLURM_ARRAY_TASK_ID", "1"}, {"SLURM_ARRAY_TASK_MIN", "0"}}),
              HasSubstr("SLURM_ARRAY_TASK_COUNT is not"));
  EXPECT_THAT(Refusal({{"SLURM_ARRAY_TASK_ID", "1"}, {"SLURM_ARRAY_TASK_COUNT", "2"}}),
              HasSubstr("SLURM_ARRAY_TASK_MIN is not"));
  EXPECT_THAT(Refusal({{"SLURM_ARRAY_TASK_ID", "9"}, {"SLURM_ARRAY_TASK_COUNT", "3"}, {"SLURM_ARRAY_TASK_MIN", "1"}}),
              HasSubstr("8 is not below the count, 3"));
  EXPECT_THAT(Refusal({{"SLURM_ARRAY_TASK_ID", "2"},
                       {"SLURM_ARRAY_TASK_COUNT", "3"},
                       {"SLURM_ARRAY_TASK_MIN", "1"},
                       {"SLURM_ARRAY_TASK_STEP", "2"}}),
              HasSubstr("a multiple of 2"));
  EXPECT_THAT(Refusal({{"JOB_COMPLETION_INDEX", "0"}, {"LATVOX_WORKER_COUNT", "1"}, {"SLURM_ARRAY_TASK_ID", "0"}}),
              HasSubstr("both set"));
  EXPECT_THAT(Refusal({{"JOB_COMPLETION_INDEX", "0"}, {"LATVOX_WORKER_COUNT", "1048577"}}),
              HasSubstr("exceeds 1048576"));
  for (const char* text : {"", "1", "1/1", "-1/2", "0/0", "1/2/3", "a/2", "0/4294967296"}) {
    EXPECT_THAT(CheckShard(text).text, HasSubstr("is not I/N with 0 <= I < N <= 1048576")) << text;
  }
  EXPECT_EQ(CheckShard("0/1").text, "");
}

TEST_F(Workers, JobsAtOnceDependOnWhoseServerItIs) {
  BatchWords words;
  EXPECT_EQ(Interpret(words).jobs, kPrivateJobs);
  words.options.server.address = "a:1";
  EXPECT_EQ(Interpret(words).jobs, kServerJobs);
  words.options.jobs = 7;
  EXPECT_EQ(Interpret(words).jobs, 7);
}

class Results : public FilesTest {
 protected:
  Results() { std::filesystem::create_directory(Path("out")); }

  Job MakeJob(const std::string& more = "") const {
    return *JobParser(Path(""), Path("out")).Parse(R"({"mesh": "m.obj", "resolution": 8)" + more + "}");
  }

  static JobResult Done(const Job& job) {
    JobResult result;
    result.outcome = JobResult::Outcome::kDone;
    result.id = job.id;
    result.line = 3;
    result.outputs = job.names;
    result.job_digest = "abc";
    result.report.summary.certificate.digest = "voxels";
    return result;
  }

  absl::StatusOr<std::unique_ptr<ResultsFile>> Open(const std::string& name,
                                                    absl::Duration limit = ResultsFile::kLockLimit) {
    return ResultsFile::Open(
        Path(name), cancellation_, [this](const std::string& line) { said_.push_back(line); }, limit);
  }

  void WriteGrid(const std::string& name, const std::string& digest) const {
    VoxelGrid grid((GridTransform()));
    Certificate certificate;
    certificate.digest = digest;
    grid.SetCertificate(certificate);
    ASSERT_TRUE(grid.Write(Path(name)).ok());
  }

  const Cancellation cancellation_;
  std::vector<std::string> said_;
};

TEST_F(Results, AreWholeLinesThatSayWhatBecameOfAJob) {
  JobResult failed;
  failed.id = "a";
  failed.line = 7;
  failed.error = absl::InvalidArgumentError("bad\nmesh");
  SetErrorDetails({"MESH", "triangles", "5", "4", {}}, failed.error);
  JobResult skipped = Done(MakeJob());
  skipped.outcome = JobResult::Outcome::kSkipped;
  skipped.digest = "voxels";
  skipped.ended_unix_ms = 5;
  skipped.bytes = {17};
  const auto file = Open("r");
  ASSERT_TRUE(file.ok()) << file.status();
  for (const JobResult& result : {failed, skipped, Done(MakeJob())}) ASSERT_TRUE((*file)->Append(result).ok());
  const std::string text = Read("r");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
  EXPECT_THAT(text, StartsWith(R"({"id":"a","line":7,"status":"failed","ended_unix_ms":0,)"));
  EXPECT_THAT(text, HasSubstr(R"("error":{"code":"INVALID_ARGUMENT","message":"bad\nmesh","exit_status":3,)"
                              R"("field":"triangles","value":"5","limit":"4"}})"));
  EXPECT_THAT(text,
              HasSubstr(R"("status":"skipped","ended_unix_ms":5,"mesh":"","outputs":["m.vdb"],"output_bytes":[17],)"
                        R"("job_digest":"abc","digest":"voxels"})"));
  EXPECT_THAT(text, HasSubstr(R"("status":"done","ended_unix_ms":0,"mesh":"","outputs":["m.vdb"],"output_bytes":[],)"
                              R"("job_digest":"abc","summary":{"voxels":0,)"));
}

TEST_F(Results, AnUnfinishedLineIsRemovedAndOthersStay) {
  for (const std::string before : {"", "{}\n", "{}\n{}\n"}) {
    for (const std::string unfinished : {"", "{\"id\"", "x"}) {
      Write("r", before + unfinished);
      ASSERT_TRUE(Open("r").ok());
      EXPECT_EQ(Read("r"), before);
    }
  }
}

TEST_F(Results, AFileInUseIsWaitedForUntilTheLimit) {
  auto first = Open("r");
  ASSERT_TRUE(first.ok());
  EXPECT_THAT(said_, IsEmpty());
  const absl::Time start = absl::Now();
  EXPECT_THAT(std::string(Open("r", absl::Milliseconds(50)).status().message()),
              HasSubstr("r: cannot be written (another latvox batch"));
  EXPECT_GE(absl::Now() - start, absl::Milliseconds(50));
  EXPECT_THAT(said_, ElementsAre(HasSubstr("waiting for up to 50ms")));
  auto second = std::async(std::launch::async, [&] { return Open("r", absl::Minutes(1)).status(); });
  EXPECT_EQ(second.wait_for(std::chrono::milliseconds(1100)), std::future_status::timeout);
  first->reset();
  EXPECT_TRUE(second.get().ok());
  EXPECT_EQ(said_.size(), 2u);  // however often it tried
  EXPECT_EQ(Open("missing/r").status().code(), absl::StatusCode::kFailedPrecondition);
}

TEST_F(Results, WaitingForAFileEndsWithTheBatch) {
  const auto first = Open("r");
  auto second = std::async(std::launch::async, [&] { return Open("r", absl::Minutes(1)).status(); });
  EXPECT_EQ(second.wait_for(std::chrono::milliseconds(50)), std::future_status::timeout);
  const absl::Time start = absl::Now();
  cancellation_.Cancel();
  EXPECT_EQ(second.get().code(), absl::StatusCode::kCancelled);
  EXPECT_LT(absl::Now() - start, absl::Seconds(20));
}

TEST_F(Results, AJobIsDoneIfRequestMeshAndOutputsAre) {
  const Job job = MakeJob(R"(, "out": ["m.vdb", "m.csv"])");
  const auto found = [&](const std::string& digest) {
    const auto done = DoneJobs::Read(Path("out"), Cancellation());
    EXPECT_TRUE(done.ok()) << done.status();
    return done->Find(job, digest);
  };
  EXPECT_EQ(found("abc"), std::nullopt);
  ASSERT_TRUE((*Open("out/results-1-of-9.jsonl"))->Append(Done(job)).ok());
  EXPECT_EQ(found("abc"), std::nullopt);
  WriteGrid("out/m.vdb", "voxels");
  EXPECT_EQ(found("abc"), std::nullopt);
  Write("out/m.csv", "i,j,k,x,y,z\n");
  EXPECT_EQ(found("abc"), "voxels");
  EXPECT_EQ(found("abd"), std::nullopt);
  WriteGrid("out/m.vdb", "others");
  EXPECT_EQ(found("abc"), std::nullopt);
  Write("out/m.vdb", "no grid");
  EXPECT_EQ(found("abc"), std::nullopt);
}

TEST_F(Results, AJobIsNotDoneIfAnOutputIsLongerOrShorterThanItWas) {
  const Job job = MakeJob(R"(, "out": ["m.csv", "m.vdb"])");
  WriteGrid("out/m.vdb", "voxels");
  const auto found = [&](const std::string& csv, const std::vector<uint64_t>& bytes) {
    Write("out/m.csv", csv);
    JobResult result = Done(job);
    result.bytes = bytes;
    Write("out/results.jsonl", ToJsonLine(result) + "\n");
    return DoneJobs::Read(Path("out"), Cancellation())->Find(job, "abc").has_value();
  };
  const uint64_t grid = std::filesystem::file_size(Path("out/m.vdb"));
  EXPECT_TRUE(found("1234", {4, grid}));
  EXPECT_FALSE(found("123", {4, grid}));
  EXPECT_FALSE(found("12345", {4, grid}));
  EXPECT_FALSE(found("1234", {4, grid + 1}));
  EXPECT_FALSE(found("1234", {4}));
  EXPECT_TRUE(found("123", {}));
}

TEST_F(Results, OfSeveralLinesTheOneThatEndedLastCountsInWhicheverFileItIs) {
  WriteGrid("out/m.vdb", "voxels");
  const auto line = [&](const std::string& digest, uint64_t ended) {
    JobResult result = Done(MakeJob());
    result.job_digest = digest;
    result.ended_unix_ms = ended;
    return ToJsonLine(result) + "\n";
  };
  const std::string before = line("old", 0);
  std::string unknown = before;
  unknown.erase(unknown.find(R"("ended_unix_ms":0,)"), std::strlen(R"("ended_unix_ms":0,)"));
  const std::string first = "out/results.jsonl", second = "out/results-1-of-2.jsonl";
  for (const std::string& old : {before, unknown, line("old", 6)}) {
    for (const auto& [a, b] : {std::pair(first, second), {second, first}}) {
      Write(a, line("new", 7));
      Write(b, old);
      const auto done = DoneJobs::Read(Path("out"), Cancellation());
      EXPECT_EQ(done->Find(MakeJob(), "new"), "voxels") << old;
      EXPECT_EQ(done->Find(MakeJob(), "old"), std::nullopt) << old;
    }
  }
  Write(first, unknown + line("new", 0));
  std::filesystem::remove(Path(second));
  EXPECT_EQ(DoneJobs::Read(Path("out"), Cancellation())->Find(MakeJob(), "new"), "voxels");
}

TEST_F(Results, LinesThatAreNoResultsAreIgnored) {
  WriteGrid("out/m.vdb", "voxels");
  const std::string done = ToJsonLine(Done(MakeJob()));
  const auto wrong = [&](const std::string& ended, const std::string& bytes) {
    return absl::StrReplaceAll(done, {{R"("ended_unix_ms":0)", R"("ended_unix_ms":)" + ended},
                                      {R"("output_bytes":[])", R"("output_bytes":)" + bytes},
                                      {R"("abc")", R"("other")"}}) +
           "\n";
  };
  Write("out/results.jsonl", wrong("1e300", "[]") + wrong("-1", "[]") + wrong("9", "[1e300]") + wrong("9", "7") +
                                 "\nnull\n[]\n{\"status\": \"done\"}\n{\"status\": 5}\n" + done + "\n{\"sta");
  EXPECT_EQ(DoneJobs::Read(Path("out"), Cancellation())->Find(MakeJob(), "abc"), "voxels");
  JobResult failed = Done(MakeJob());
  failed.outcome = JobResult::Outcome::kFailed;
  failed.error = absl::CancelledError();
  Write("out/results.jsonl", ToJsonLine(failed) + "\n");
  EXPECT_EQ(DoneJobs::Read(Path("out"), Cancellation())->Find(MakeJob(), "abc"), std::nullopt);
}

TEST_F(Results, EachWorkerHasAFileOfItsOwn) {
  EXPECT_EQ(ResultsName({}), "results.jsonl");
  EXPECT_EQ(ResultsName({2, 7}), "results-2-of-7.jsonl");
}

TEST_F(Results, AJobsDigestIsOfRequestOutputsAndMesh) {
  const std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  Write("m.obj", mesh);
  Write("copy.obj", mesh);
  Write("other.obj", mesh + "\n");
  const auto digest = [&](const std::string& fields) {
    const auto job = JobParser(Path(""), Path("out")).Parse("{" + fields + "}");
    EXPECT_TRUE(job.ok()) << job.status();
    const auto found = JobDigest(*job);
    EXPECT_TRUE(found.ok()) << found.status();
    return found.value_or("");
  };
  const std::string out = R"("out": "m.vdb", )", plain = digest(out + R"("mesh": "m.obj", "resolution": 8)");
  EXPECT_EQ(plain.size(), 64u);
  // The same job, written differently.
  EXPECT_EQ(digest(R"("mesh": "copy.obj", "resolution": 8, "id": "x", "out": "./m.vdb")"), plain);
  EXPECT_EQ(digest(out + R"("mesh": "m.obj", "resolution": 8, "lattice": "cartesian", "minimal": true)"), plain);
  EXPECT_EQ(digest(out + R"("mesh": "m.obj", "resolution": 8, "separability": 26, "encoding": "masks")"), plain);
  std::set<std::string> digests = {plain};
  for (const char* fields : {R"("mesh": "other.obj", "resolution": 8)",
                             R"("mesh": "m.obj", "resolution": 9)",
                             R"("mesh": "m.obj", "voxel_size": 8)",
                             R"("mesh": "m.obj", "resolution": 8, "lattice": "bcc")",
                             R"("mesh": "m.obj", "basis": [1,0,0,0,1,0,0,0,1])",
                             R"("mesh": "m.obj", "basis": [1,0,0,0,1,0,0,0,2])",
                             R"("mesh": "m.obj", "resolution": 8, "origin": [0,0,1])",
                             R"("mesh": "m.obj", "resolution": 8, "separability": 1)",
                             R"("mesh": "m.obj", "resolution": 8, "minimal": false)",
                             R"("mesh": "m.obj", "resolution": 8, "verify": true)",
                             R"("mesh": "m.obj", "resolution": 8, "algorithm": "brute-force")",
                             R"("mesh": "m.obj", "resolution": 8, "region": [0,0,0,1,1,1])",
                             R"("mesh": "m.obj", "resolution": 8, "region": [0,0,0,1,1,2])",
                             R"("mesh": "m.obj", "resolution": 8, "bounds": [0,0,0,1,1,1])",
                             R"("mesh": "m.obj", "resolution": 8, "bounds": [0,0,0,1,1,2])",
                             R"("mesh": "m.obj", "resolution": 8, "quantization": 12)",
                             R"("mesh": "m.obj", "resolution": 8, "band": 1)",
                             R"("mesh": "m.obj", "resolution": 8, "band": "1v")",
                             R"("mesh": "m.obj", "resolution": 8, "band": 1, "signed": true)",
                             R"("mesh": "m.obj", "resolution": 8, "fields": "normal")",
                             R"("mesh": "m.obj", "resolution": 8, "fields": ["normal", "distance"])",
                             R"("mesh": "m.obj", "resolution": 8, "set": "solid")",
                             R"("mesh": "m.obj", "resolution": 8, "set": "solid", "rule": "winding")",
                             R"("mesh": "m.obj", "resolution": 8, "set": "interior")",
                             R"("mesh": "m.obj", "resolution": 8, "set": "solid", "force_open": true)",
                             R"("mesh": "m.obj", "resolution": 8, "shard": "0/2")",
                             R"("mesh": "m.obj", "resolution": 8, "shard": "1/2")"}) {
    EXPECT_TRUE(digests.insert(digest(out + fields)).second) << fields;
  }
  EXPECT_TRUE(digests.insert(digest(R"("out": ["m.vdb", "m.csv"], "mesh": "m.obj", "resolution": 8)")).second);
}

TEST_F(Results, OfAMeshInSeveralFilesEveryOneCounts) {
  const auto digest = [&](const std::vector<float>& positions) {
    Write("m.bin", {reinterpret_cast<const char*>(positions.data()), positions.size() * sizeof(float)});
    const auto found = JobDigest(*JobParser(Path(""), Path("out")).Parse(R"({"mesh": "m.gltf", "resolution": 8})"));
    EXPECT_TRUE(found.ok()) << found.status();
    return found.value_or("");
  };
  Write("m.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "buffers": [{"uri": "m.bin", "byteLength": 36}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0,0,0], "max": [1,1,1]}]})");
  const std::string first = digest({0, 0, 0, 1, 0, 0, 0, 1, 0});
  EXPECT_EQ(digest({0, 0, 0, 1, 0, 0, 0, 1, 0}), first);
  EXPECT_NE(digest({0, 0, 0, 1, 0, 0, 0, 0, 1}), first);
}

}  // namespace
}  // namespace latvox::client
