// The command line: files and their shapes.
#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "client/tool/cli/field_list.h"
#include "client/tool/output/output.h"
#include "tests/unit/client/tool/cli/parsed.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(FileOptions, AnOutputThatIsNotGivenHasTheMeshsName) {
  const auto parse = [](std::vector<std::string> words) {
    CommandParser parser;
    VoxelizeWords voxelize;
    AddVoxelizeOptions(parser, voxelize);
    parser.Parse(std::move(words));
    return Interpret(voxelize);
  };
  EXPECT_THAT(parse({"folder/mesh.tar.obj"}).outputs, ElementsAre("mesh.tar.vdb"));
  EXPECT_THAT(parse({"folder/mesh.obj.gz"}).outputs, ElementsAre("mesh.vdb"));
  EXPECT_THAT(parse({"a.obj", "b.obj"}).outputs, ElementsAre("a.vdb"));
  EXPECT_THAT(parse({"a.obj", "--json"}).outputs, ElementsAre());
  EXPECT_THAT(parse({"a.obj", "--verify"}).outputs, ElementsAre());
  EXPECT_EQ(parse({"a.obj"}).standard_output, std::nullopt);
  const VoxelizeOptions standard = parse({"a.obj", "-o", "b.vdb", "-o", "-", "--output-format", "CSV"});
  EXPECT_EQ(standard.standard_output, 1u);
  EXPECT_THAT(standard.outputs, ElementsAre("b.vdb", "-.csv"));
}

TEST(FileOptions, RefusalsOfOutputsNameWhatIsWrong) {
  EXPECT_THAT(RefusalOfAll({"voxelize", "-"}), HasSubstr("--out is required: a mesh from standard input has no name"));
  EXPECT_THAT(RefusalOfAll({"voxelize", "a.obj", "--output-format", "csv"}),
              HasSubstr("--output-format: csv needs -o -"));
  EXPECT_THAT(RefusalOfAll({"voxelize", "a.obj", "-o", "-", "-o", "-"}), HasSubstr("- is given twice"));
  EXPECT_THAT(RefusalOfAll({"voxelize", "a.obj", "-o", "-", "--json"}),
              HasSubstr("--json cannot be combined with -o -"));
}

TEST(FileOptions, RefusalsOfFilesNameOptionValueAndLimit) {
  Refuses({"--resolution", "9", "--up-axis", "w"}, {"--up-axis", "w", "x, y"});
  Refuses({"--resolution", "9", "--scale", "-1"}, {"--scale", "-1", "above 0"});
  Refuses({"--resolution", "9", "--input-format", "fbx"}, {"--input-format", "fbx", "3mf"});
  Refuses({"--resolution", "9", "--npy", "sparse"}, {"--npy", "sparse", "dense"});
  Refuses({"--resolution", "9", "--npy", "dense"}, {"--npy", "dense", "--out"});
  Refuses({"--resolution", "9", "-", "-"}, {"-", "twice"});
  for (const char* path : {"a.vox", "a.BINVOX"}) {
    Refuses({"--resolution", "9", "--lattice", "bcc", "-o", path}, {"--out", path, "--lattice cartesian"});
    Refuses({"--voxel-size", "1,1,2", "-o", path}, {"--out", path, "--lattice cartesian"});
    Refuses({"--basis", "1,0,0,0,1,0,0,1,1", "-o", path}, {"--out", path, "--lattice cartesian"});
    EXPECT_EQ(Refusal({"--basis", "2,0,0,0,2,0,0,0,2", "-o", path}), "accepted");
  }
  Refuses({"--resolution", "9", "-o", "a.xyz"}, {"a.xyz", ".vdb"});
  Refuses({"--resolution", "9", "-o", "./out.vdb"}, {"out.vdb", "twice"});
}

TEST(FileOptions, ShapesNeedAnArrayWithAShape) {
  const VoxelizeOptions options = Parse({"--dims", "64,48,40", "--pad", "3", "-o", "a.nrrd"});
  EXPECT_EQ(options.output_options.shape, (BoxShape{.pad = 3, .dims = Vec3i{64, 48, 40}}));
  EXPECT_TRUE(options.is_fitted());
  EXPECT_EQ(options.request.resolution, 128U);  // no step along an index is longer than two voxels
  EXPECT_FALSE(Parse({"--dims", "64,48,40", "--resolution", "9", "-o", "a.nrrd"}).is_fitted());
  EXPECT_EQ(Parse({"--dims", "64,48,40", "--voxel-size", "1", "-o", "a.nii.gz"}).request.resolution, std::nullopt);
  EXPECT_EQ(Parse({"--pad", "1", "-o", "a.npy", "--npy", "dense"}).request.resolution, 256U);
  Refuses({"--dims", "9,9"}, {"--dims", "9,9", "3 whole numbers"});
  Refuses({"--dims", "9,0,9"}, {"--dims", "9,0,9", "from 1 to 1048576"});
  Refuses({"--pad", "-1"}, {"--pad", "-1", "0 to 65536"});
  Refuses({"--dims", "9,9,9", "--pad", "5", "-o", "a.npz"}, {"--dims", "9,9,9", "--pad 5", "leaves no voxel"});
  Refuses({"--dims", "9,9,9", "-o", "a.npy"}, {"--dims", "needs an output", ".nrrd", "--npy dense"});
  Refuses({"--pad", "1", "-o", "a.csv"}, {"--pad", ".npz", ".vti"});
}

TEST(FileOptions, ArraySelectsTheFieldsOfFilesOfOneArray) {
  const std::vector<std::string> labeled = {"--set", "solid", "--labels", "part", "--fields", "distance"};
  const auto with = [&labeled](std::vector<std::string> words) {
    words.insert(words.end(), labeled.begin(), labeled.end());
    return words;
  };
  for (const char* path : {"a.nrrd", "a.mha", "a.nii"}) {
    Refuses(with({"-o", path}), {"--fields", path, "cannot hold distance,part", ".vdb", "--array selects some"});
    EXPECT_EQ(Refusal(with({"-o", path, "--array", "distance"})), "accepted");
    EXPECT_EQ(Refusal(with({"-o", path, "--array", "none"})), "accepted");
    Refuses(with({"-o", path, "--array", "normal"}), {"--array: normal is not among --fields"});
  }
  EXPECT_EQ(Refusal(with({"-o", "a.binvox", "--array", "none"})), "accepted");
  Refuses(with({"-o", "a.binvox"}), {"a.binvox cannot hold distance,part", "and --array none leaves them out"});
  EXPECT_EQ(Refusal({"-o", "a.nii", "--set", "links", "--fields", "links"}), "accepted");
  for (const char* path : {"a.glb", "a.vox"}) {
    Refuses(with({"-o", path}), {"--fields", path, "cannot hold distance,part", "--array selects some"});
    Refuses(with({"-o", path, "--array", "distance"}), {"--array", path, "cannot hold distance; .vdb"});
    EXPECT_EQ(Refusal(with({"-o", path, "--array", "part"})), "accepted");
    EXPECT_EQ(Refusal(with({"-o", path, "--array", "none"})), "accepted");
  }
  Refuses({"-o", "a.links.csv", "--fields", "part,links"}, {"a.links.csv", "--array selects some"});
  EXPECT_EQ(Refusal({"-o", "a.links.csv", "--fields", "part,links", "--array", "links"}), "accepted");
  Refuses({"-o", "a.links.csv", "--fields", "part,links", "--array", "none"},
          {"--array", "cannot hold voxels without"});
  EXPECT_EQ(Refusal(with({"-o", "a.npy", "--npy", "dense", "--array", "part"})), "accepted");
  const VoxelizeOptions options = Parse(with({"-o", "a.nii", "--array", "distance"}));
  EXPECT_THAT(options.output_options.array, testing::Optional(ElementsAre(Field::kDistance)));
  EXPECT_THAT(options.request.fields, ElementsAre(Field::kDistance, Field::kPart));
  Refuses({"-o", "a.nii", "--fields", "part,material,normal", "--array", "part,material"},
          {"--array", "a.nii", "cannot hold part,material", ".nrrd"});
  Refuses(with({"-o", "a.npy", "--array", "part"}),
          {"--array", "needs an output that cannot hold all fields: .npy .glb .vox .nrrd .mha .mhd .nii .nii.gz",
           "--npy dense"});
  Refuses(with({"-o", "a.nii", "--array", "part,part"}), {"--array", "part", "twice"});
  Refuses(with({"-o", "a.nii", "--array", "weight"}), {"--array", "weight", "neither none nor a field"});
  for (const char* list : {"part,none", "none,part", "none,none"}) {
    Refuses(with({"-o", "a.nii", "--array", list}), {"--array", "\"none\" stands alone"});
  }
  for (const auto& [list, value] : {std::pair("part,part", "part"), {"part,none", "none"}, {"part,weight", "weight"}}) {
    EXPECT_EQ(CheckFieldList(list).value, value) << list;
  }
}

TEST(FileOptions, ImagesHoldOneFieldAndCellsBoxes) {
  EXPECT_EQ(Refusal({"--resolution", "9", "--fields", "part", "-o", "a.nii.gz"}), "accepted");
  EXPECT_EQ(Refusal({"--voxel-size", "1,1,2", "-o", "a.vti"}), "accepted");
  Refuses({"--resolution", "9", "--fields", "part,normal", "-o", "a.mha"},
          {"a.mha", "part,normal", ".vdb .nvdb .csv .npy .npz .ply .png .html .vti .vtu .cells.vtu .h5 can"});
  EXPECT_EQ(Refusal({"--resolution", "9", "--fields", "links", "-o", "a.vti"}), "accepted");
  Refuses({"--resolution", "9", "--fields", "links", "-o", "a.glb"},
          {"links", ".vdb .nvdb .csv .npy .npz .ply .png .html .vti .vtu .cells.vtu .h5 .links.csv .links.npz .nrrd"});
  Refuses({"--resolution", "9", "--lattice", "bcc", "-o", "a.VTI"}, {"a.VTI", "--lattice cartesian", ".vtu"});
}

using Words = std::vector<std::string>;

Words Joined(const std::vector<Words>& parts) {
  Words all;
  for (const Words& words : parts) all.insert(all.end(), words.begin(), words.end());
  return all;
}

// A format, and whether its --npy is dense.
using Form = std::pair<std::string, bool>;

// Returns the words of a call, which each file below has in common. Parsing takes longer than all else.
VoxelizeWords ParsedWords(const Words& call) {
  CommandParser parser;
  VoxelizeWords words;
  AddVoxelizeOptions(parser, words);
  parser.Parse(Joined({{"a.obj", "-o", "a.vdb"}, call}));
  return words;
}

// Returns the refusal of a call with this file alone. An --array that only other formats take is left out.
std::string RefusalOf(const Form& form, VoxelizeWords words, const std::string& array) {
  const auto& [extension, dense] = form;
  const std::string path = "a" + extension;
  words.options.outputs = {path};
  if (dense) words.shape.npy = "dense";
  if (IsLimited(path, {.dense_npy = dense})) words.shape.array = array;
  try {
    Interpret(words);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

std::vector<Form> AllForms() {
  std::vector<Form> forms = {{".npy", true}};
  for (const std::string& extension : OutputExtensions()) forms.emplace_back(extension, false);
  return forms;
}

// Returns the formats that a refusal names.
Words Named(const std::string& refusal) {
  Words named;
  for (const absl::string_view word : absl::StrSplit(refusal, absl::ByAnyChar(" ;,"))) {
    const auto& known = OutputExtensions();
    if (std::find(known.begin(), known.end(), word) != known.end()) named.emplace_back(word);
  }
  return named;
}

const std::vector<Words> kLattices = {{},
                                      {"--lattice", "bcc"},
                                      {"--lattice", "hexagonal"},
                                      {"--voxel-size", "1,1,2"},
                                      {"--lattice", "fcc", "--voxel-size", "1,1,2"},
                                      {"--basis", "1,0,0,0,1,0,0,0,2"},
                                      {"--basis", "1,0,0,0.2,1,0,0.1,0,1"},
                                      {"--align", "b.vdb"}};
const std::vector<Words> kSets = {{}, {"--band", "2v"}, {"--set", "solid", "--labels", "part"}, {"--set", "links"}};
const char* const kFieldLists[] = {"",
                                   "part",
                                   "color",
                                   "distance",
                                   "normal,distance",
                                   "part,material",
                                   "part,distance",
                                   "links",
                                   "links,link_triangles",
                                   "distance,links"};
const char* const kArrays[] = {"", "none", "part", "distance"};

TEST(FileOptions, RefusalsOfFormatsNameOnlyFormatsThatHoldTheSameCall) {
  std::map<bool, size_t> answers;  // whether accepted
  for (const Words& lattice : kLattices) {
    for (const Words& set : kSets) {
      for (const char* const fields : kFieldLists) {
        const Words call = Joined({lattice, set, *fields != 0 ? Words{"--fields", fields} : Words{}});
        const VoxelizeWords words = ParsedWords(call);
        for (const char* const array : kArrays) {
          std::map<Form, std::string> refusals;
          for (const Form& form : AllForms()) refusals[form] = RefusalOf(form, words, array);
          for (const auto& [form, refusal] : refusals) {
            ++answers[refusal == "accepted"];
            if (refusal == "accepted" || absl::StrContains(refusal, "is not among --fields")) continue;
            const bool has_array = IsLimited("a" + form.first, {.dense_npy = form.second});
            if (*array != 0 && !has_array) continue;  // formats with --array are refused for another call
            SCOPED_TRACE(testing::Message() << absl::StrJoin(call, " ") << " " << array << ": " << refusal);
            const Words named = Named(refusal);
            EXPECT_EQ(named.empty(), absl::StrContains(refusal, "needs links, "));
            for (const std::string& other : named) EXPECT_EQ(refusals.at({other, false}), "accepted") << other;
          }
        }
      }
    }
  }
  EXPECT_GT(answers[true], 1000U);
  EXPECT_GT(answers[false], 1000U);
}

// Options of arrays name formats, too.
TEST(FileOptions, OptionsOfArraysNameOnlyFormatsThatHoldTheSameCall) {
  for (const Words& lattice : kLattices) {
    for (const char* const fields : kFieldLists) {
      const Words call = Joined({lattice, *fields != 0 ? Words{"--fields", fields} : Words{}});
      for (const bool is_array : {true, false}) {
        VoxelizeWords words = ParsedWords(call);
        if (!is_array) words.shape.pad = "1";
        const std::string array = !is_array ? "" : *fields != 0 ? fields : "none";
        VoxelizeWords of_csv = words;
        of_csv.shape.array = array;
        const std::string refusal = RefusalOf({".csv", false}, of_csv, "");
        SCOPED_TRACE(absl::StrJoin(call, " ") + ": " + refusal);
        EXPECT_THAT(refusal, HasSubstr(is_array ? "--array: needs an output " : "--pad: needs an output "));
        const Words named = Named(refusal);
        for (const Form& form : AllForms()) {
          const auto& [extension, dense] = form;
          const bool has_option = !is_array || IsLimited("a" + extension, {.dense_npy = dense});
          if (!has_option || (extension == ".npy" && !dense)) continue;
          const bool is_named = std::find(named.begin(), named.end(), extension) != named.end();
          const std::string other = RefusalOf(form, words, array);
          // With --align, a format is named if it holds each lattice.
          const bool is_certain = lattice.empty() || lattice[0] != "--align";
          if (is_named || is_certain) {
            EXPECT_EQ(other == "accepted", is_named) << extension << ": " << other;
          }
        }
        const bool says_none = absl::StrContains(refusal, "no such format can hold");
        EXPECT_EQ(named.empty(), says_none);
        EXPECT_TRUE(is_array || !says_none);
      }
    }
  }
  EXPECT_EQ(RefusalOfAll({"voxelize", "a.obj", "-o", "a.csv", "--fields", "part,distance", "--array", "part,distance"}),
            "--array: needs an output that cannot hold all fields, and no such format can hold part,distance");
}

TEST(FileOptions, WhatIsSentOnIsNamedOnlyAsOneFile) {
  const Words call = {"voxelize", "a.obj", "--fields", "part,material"};
  for (const Words& output : {Words{"-o", "-", "--output-format", "nii"}, Words{"-o", "s3://bucket/a.nii"}}) {
    EXPECT_THAT(Named(RefusalOfAll(Joined({call, output}))),
                testing::AllOf(testing::Contains(".mha"), testing::Not(testing::Contains(".mhd"))));
  }
  EXPECT_THAT(Named(RefusalOfAll(Joined({call, {"-o", "a.nii"}}))), testing::Contains(".mhd"));
}

// Otherwise a mesh that follows would be overwritten.
TEST(FileOptions, AnOutputIsOneWord) {
  const VoxelizeOptions options = Parse({"-o", "b.csv", "b.obj", "--out", "c.csv", "c.obj", "--resolution", "9"});
  EXPECT_THAT(options.outputs, ElementsAre("out.vdb", "b.csv", "c.csv"));
  EXPECT_THAT(options.mesh.paths, ElementsAre("mesh.obj", "b.obj", "c.obj"));
}

}  // namespace
}  // namespace latvox::client
