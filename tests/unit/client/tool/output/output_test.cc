#include "client/tool/output/output.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <functional>
#include <set>
#include <string>

#include "client/internal/liveness.h"
#include "client/tool/output/atomic_file.h"
#include "client/tool/output/temporary_name.h"
#include "latvox/error.h"
#include "latvox/grid/voxel_grid.h"
#include "tests/unit/client/fields.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

class OutputFile : public FilesTest {
 protected:
  // BCC, so that axes are not orthogonal. Two bricks, one with negative coordinates; voxels (0,0,0), (7,7,7), (-8,2,3).
  static Accepted MakeAccepted() {
    Accepted accepted;
    accepted.grid = {{{0.2, 0, 0}, {0, 0.2, 0}, {0.1, 0.1, 0.1}}, {1, 2, 3}, 0.15874010519681994};
    accepted.index_box = IndexBox{{-8, 0, 0}, {8, 8, 8}};
    accepted.mesh.min = {0, 1, 2};
    accepted.mesh.max = {4, 4, 4};
    return accepted;
  }

  static std::vector<Brick> MakeBricks() {
    Brick low{{-1, 0, 0}, {}}, high{{0, 0, 0}, {}};
    low.mask[0] = uint64_t{1} << (2 << 3 | 3);
    high.mask[0] = 1;
    high.mask[7] = uint64_t{1} << 63;
    return {low, high};
  }

  // Runs everything except Commit.
  std::unique_ptr<Output> Fill(const std::string& name) const {
    const MakePage page = [](const GridContent& content, const std::string& title, UpAxis up) {
      return absl::StrCat(title, ", ", content.file.info.active_voxels, " voxels", up == UpAxis::kZ ? ", z up" : "");
    };
    VoxelizeRequest request;
    std::vector<FieldValues> values;
    Accepted accepted = MakeAccepted();
    if (name.find(".links.") != std::string::npos) {  // a crossing in each voxel
      request.fields = {Field::kLinkCrossings};
      accepted.neighbors = {{1, 0, 0}};
      values = {{Field::kLinkCrossings, std::vector<std::byte>(3 * sizeof(uint32_t), std::byte{1}), 1}};
    }
    auto output = OpenOutput(Path(name), request, {.picture_up = UpAxis::kZ, .make_page = page});
    EXPECT_TRUE(output.ok()) << output.status();
    if (name.ends_with("vox") || name.ends_with("vti"))
      accepted.grid.basis = {{0.2, 0, 0}, {0, 0.2, 0}, {0, 0, 0.2}};  // formats of cubes
    EXPECT_TRUE((*output)->Begin(accepted).ok());
    const std::vector<Brick> bricks = MakeBricks();
    EXPECT_TRUE((*output)->Add({bricks, 1, values}).ok());
    EXPECT_TRUE((*output)->Finish({}).ok());
    return *std::move(output);
  }
};

TEST_F(OutputFile, CsvHoldsCoordinatesAndPositionsWithSeventeenDigits) {
  ASSERT_TRUE(Fill("o.csv")->Commit().ok());
  std::string expected = "i,j,k,x,y,z\n";
  const GridTransform grid = MakeAccepted().grid;
  for (const Vec3i& ijk : {Vec3i{-8, 2, 3}, {0, 0, 0}, {7, 7, 7}}) {
    const Vec3d p = grid.ToWorld(ijk);
    char line[200];
    std::snprintf(line, sizeof(line), "%d,%d,%d,%.17g,%.17g,%.17g\n", ijk[0], ijk[1], ijk[2], p[0], p[1], p[2]);
    expected += line;
  }
  EXPECT_EQ(Read("o.csv"), expected);
  EXPECT_THAT(expected, HasSubstr("\n0,0,0,1,2,3\n"));
  EXPECT_THAT(expected, HasSubstr("7,7,7,3.1000000000000005,"));
}

TEST_F(OutputFile, NpyIsAnArrayOfShapeVoxelsByThree) {
  ASSERT_TRUE(Fill("o.npy")->Commit().ok());
  const std::string npy = Read("o.npy");
  EXPECT_THAT(npy, StartsWith(std::string("\x93NUMPY\x01\x00\x76\x00", 10) +
                              "{'descr': '<i4', 'fortran_order': False, 'shape': (3, 3), }"));
  ASSERT_EQ(npy.size(), 128u + 3 * 12);
  EXPECT_EQ(npy[127], '\n');
  std::array<int32_t, 9> values;
  std::memcpy(values.data(), npy.data() + 128, sizeof(values));
  EXPECT_THAT(values, ElementsAre(-8, 2, 3, 0, 0, 0, 7, 7, 7));
}

TEST_F(OutputFile, PlyHoldsAsManyPointsAsItDeclares) {
  ASSERT_TRUE(Fill("o.ply")->Commit().ok());
  const std::string ply = Read("o.ply");
  EXPECT_THAT(ply, HasSubstr("\nelement vertex 3\n"));
  const size_t header = ply.find("end_header\n") + 11;
  ASSERT_EQ(ply.size(), header + 3 * 36);
  std::array<double, 3> position;
  std::array<int32_t, 3> ijk;
  std::memcpy(position.data(), ply.data() + header + 36, 24);
  std::memcpy(ijk.data(), ply.data() + header + 60, 12);
  EXPECT_THAT(position, ElementsAre(1, 2, 3));
  EXPECT_THAT(ijk, ElementsAre(0, 0, 0));
}

TEST_F(OutputFile, TablesOfABandHoldDistances) {
  VoxelizeRequest request;
  request.set = Band{.width = 2};
  request.fields = {Field::kDistance};
  const std::vector<Brick> bricks = MakeBricks();
  const std::vector<float> values{0.1F, 2, -1.5F};
  const std::vector<FieldValues> fields{ValuesOf<float>(Field::kDistance, values)};
  for (const char* name : {"o.csv", "o.npy", "o.ply"}) {
    auto output = OpenOutput(Path(name), request);
    ASSERT_TRUE(output.ok()) << output.status();
    ASSERT_TRUE((*output)->Begin(MakeAccepted()).ok());
    ASSERT_TRUE((*output)->Add({bricks, 1, fields}).ok());
    ASSERT_TRUE((*output)->Finish({}).ok());
    ASSERT_TRUE((*output)->Commit().ok());
  }
  EXPECT_THAT(Read("o.csv"), StartsWith("i,j,k,x,y,z,distance\n-8,2,3,"));
  EXPECT_THAT(Read("o.csv"), HasSubstr(",0.100000001\n0,0,0,1,2,3,2\n7,7,7,"));
  const std::string npy = Read("o.npy"), ply = Read("o.ply");
  EXPECT_THAT(npy, HasSubstr("{'descr': [('ijk', '<i4', (3,)), ('distance', '<f4')], 'fortran_order': False, "
                             "'shape': (3,), }"));
  ASSERT_EQ(npy.size(), 128u + 3 * 16);
  EXPECT_THAT(ply, HasSubstr("property int k\nproperty float distance\nend_header\n"));
  for (size_t n = 0; n < 3; ++n) {
    float in_npy, in_ply;
    std::memcpy(&in_npy, &npy[npy.size() - 16 * (3 - n) + 12], 4);
    std::memcpy(&in_ply, &ply[ply.size() - 40 * (3 - n) + 36], 4);
    EXPECT_EQ(in_npy, values[n]);
    EXPECT_EQ(in_ply, values[n]);
  }
  EXPECT_THAT(std::string(OpenOutput(Path("o.glb"), request).status().message()),
              HasSubstr("o.glb: cannot hold distance; .vdb .nvdb .csv .npy .npz .ply .png .html"));
}

TEST_F(OutputFile, PngIsAPicture) {
  ASSERT_TRUE(Fill("o.png")->Commit().ok());
  EXPECT_THAT(Read("o.png"), StartsWith("\x89PNG\r\n"));
}

TEST_F(OutputFile, VdbHoldsTheVoxels) {
  ASSERT_TRUE(Fill("o.vdb")->Commit().ok());
  const auto info = ReadGridFileInfo(Path("o.vdb"));
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->active_voxels, 3u);
  EXPECT_EQ(info->active_box, (IndexBox{{-8, 0, 0}, {8, 8, 8}}));
}

TEST_F(OutputFile, HtmlIsThePageOfTheVdb) {
  ASSERT_TRUE(Fill("o.html")->Commit().ok());
  EXPECT_EQ(Read("o.html"), "o, 3 voxels, z up");
}

TEST_F(OutputFile, AnErrorOfThePageNamesTheTarget) {
  const MakePage page = [](const auto&...) { return absl::ResourceExhaustedError("too many"); };
  auto output = OpenOutput(Path("o.html"), {}, {.make_page = page});
  ASSERT_TRUE(output.ok() && (*output)->Begin(MakeAccepted()).ok());
  EXPECT_EQ((*output)->Finish({}), absl::ResourceExhaustedError(Path("o.html") + ": too many"));
  output->reset();
  EXPECT_THAT(Names(), ElementsAre());
}

TEST_F(OutputFile, NothingIsThereBeforeCommitAndNothingIsLeftWithoutIt) {
  for (const std::string& extension : OutputExtensions()) {
    const std::string fresh = "fresh" + extension, old = "old" + extension;
    Write(old, "old");
    {
      const auto first = Fill(fresh), second = Fill(old);
      EXPECT_FALSE(std::filesystem::exists(Path(fresh)));
      EXPECT_EQ(Read(old), "old");
    }
    EXPECT_THAT(Names(), ElementsAre(old));
    EXPECT_EQ(Read(old), "old");
    ASSERT_TRUE(Fill(old)->Commit().ok());
    EXPECT_EQ(Names(), extension == ".mhd" ? std::set<std::string>({old, "old.raw"}) : std::set<std::string>({old}));
    EXPECT_NE(Read(old), "old");
    for (const std::string& name : Names()) std::filesystem::remove(Path(name));
  }
}

TEST_F(OutputFile, PlacesThatCannotBeWrittenAreFoundOnOpening) {
  const auto refuses = [](const std::string& path, const std::string& why) {
    const absl::Status refused = OpenOutput(path).status();
    EXPECT_EQ(refused.code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_EQ(refused.message(), absl::StrCat(path, ": cannot be written (", why, ")"));
    EXPECT_EQ(GetErrorDetails(refused).field, "--out");
    EXPECT_EQ(GetErrorDetails(refused).value, path);
  };
  refuses(Path("missing/o.csv"), "there is no folder " + Path("missing"));
  std::filesystem::create_directory(Path("dir.csv"));
  EXPECT_THAT(std::string(OpenOutput(Path("dir.csv")).status().message()), HasSubstr("is a directory"));
  ASSERT_EQ(mkfifo(Path("pipe.csv").c_str(), 0600), 0);
  std::filesystem::create_symlink("/dev/null", Path("null.csv"));
  for (const char* name : {"pipe.csv", "null.csv"}) refuses(Path(name), "is not a regular file");
  EXPECT_THAT(std::string(OpenOutput(Path("o.xyz")).status().message()), HasSubstr(".xyz"));
}

TEST_F(OutputFile, ATemporaryFileThatVanishesIsAnErrorThatNamesTheTarget) {
  const auto file = AtomicFile::Create(Path("x.csv"), AtomicFile::Form::kNamed);
  ASSERT_TRUE(file.ok());
  std::filesystem::remove((*file)->temporary());
  EXPECT_THAT(std::string((*file)->Commit().message()), HasSubstr("x.csv"));
}

std::vector<std::string> NamesIn(const std::string& directory) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) names.push_back(entry.path().filename());
  return names;
}

TEST_F(OutputFile, FilesOfBothFormsReplaceTheTargetAndLeaveNothing) {
  for (const auto form : {AtomicFile::Form::kUnnamed, AtomicFile::Form::kNamed}) {
    Write("x.csv", "old");
    for (const bool commits : {false, true}) {
      auto file = AtomicFile::Create(Path("x.csv"), form);
      ASSERT_TRUE(file.ok());
      ASSERT_TRUE((*file)->Append("new").ok());
      ASSERT_TRUE((*file)->Sync().ok());
      EXPECT_EQ(Read("x.csv"), "old");
      if (commits) {
        ASSERT_TRUE((*file)->Commit().ok());
      }
      file->reset();
      EXPECT_EQ(Read("x.csv"), commits ? "new" : "old");
      EXPECT_THAT(NamesIn(Path("")), ElementsAre("x.csv"));
    }
  }
}

// Runs in a child process, which is killed then.
void KillIn(const std::function<void()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    work();
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
}

TEST_F(OutputFile, WhatAKilledProcessLeavesGoesWithTheNextFileOfTheSameTarget) {
  for (int n = 0; n < 3; ++n) {
    KillIn([&] {
      const auto first = AtomicFile::Create(Path("x.csv"), AtomicFile::Form::kNamed);
      const auto second = AtomicFile::Create(Path("x.csv"), AtomicFile::Form::kNamed);
      if (!first.ok() || !second.ok()) _exit(1);
      kill(getpid(), SIGKILL);
    });
    EXPECT_EQ(NamesIn(Path("")).size(), 2u);
  }
  for (int n = 0; n < 2; ++n) KillIn([&] { const auto file = AtomicFile::Create(Path("x.csv")).value()->Commit(); });
  ASSERT_TRUE(AtomicFile::Create(Path("x.csv"), AtomicFile::Form::kNamed).value()->Commit().ok());
  RemoveAbandonedFiles(Path(""));
  EXPECT_THAT(NamesIn(Path("")), ElementsAre("x.csv"));
}

TEST_F(OutputFile, TheFilesOfLivingProcessesAndOfOthersStay) {
  const auto file = AtomicFile::Create(Path("x.csv"), AtomicFile::Form::kNamed);
  ASSERT_TRUE(file.ok());
  const std::string name = std::filesystem::path((*file)->temporary()).filename();
  std::string of_another_kernel = name;
  of_another_kernel.replace(name.find(KernelTag()), KernelTag().size(), "01234567");
  for (const std::string& foreign : {of_another_kernel, std::string(".latvox-notes"), std::string(".x.csv.part")}) {
    Write(foreign, "");
  }
  std::filesystem::create_directory(Path(name + ".part"));
  RemoveAbandonedFiles(Path(""));
  const auto other = AtomicFile::Create(Path("x.csv"), AtomicFile::Form::kNamed);
  ASSERT_TRUE(other.ok());
  EXPECT_NE((*other)->temporary(), (*file)->temporary());
  EXPECT_EQ(NamesIn(Path("")).size(), 6u);
}

TEST_F(OutputFile, NamesOf255BytesCanBeWrittenInBothForms) {
  const std::string name(255, 'n'), too_long(256, 'n');
  for (const auto form : {AtomicFile::Form::kUnnamed, AtomicFile::Form::kNamed}) {
    ASSERT_TRUE(AtomicFile::Create(Path(name), form).value()->Commit().ok());
    EXPECT_THAT(std::string(AtomicFile::Create(Path(too_long), form).status().message()),
                HasSubstr("File name too long"));
  }
}

TEST_F(OutputFile, ReplacingASymbolicLinkChangesTheFileThatItLeadsTo) {
  Write("real.csv", "old");
  std::filesystem::create_symlink("real.csv", Path("link.csv"));
  ASSERT_TRUE(Fill("link.csv")->Commit().ok());
  EXPECT_TRUE(std::filesystem::is_symlink(Path("link.csv")));
  EXPECT_THAT(Read("real.csv"), StartsWith("i,j,k"));
}

TEST_F(OutputFile, FilesHaveTheModeOfTheUmask) {
  const mode_t old = umask(027);
  ASSERT_TRUE(Fill("o.csv")->Commit().ok());
  umask(old);
  struct stat status;
  ASSERT_EQ(stat(Path("o.csv").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
}

}  // namespace
}  // namespace latvox::client
