#include "client/cli/compare_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/cli/voxel_difference.h"

namespace latvox::client {
namespace {

using Json = nlohmann::ordered_json;

struct Report {
  bool equal;
  uint64_t voxels_a, voxels_b;
  VoxelDifference voxels;
  std::vector<FieldDifference> fields;
};

// Whether the same coordinates are the same place in both.
bool SamePlaces(const std::vector<FieldDifference>& fields) {
  return std::none_of(fields.begin(), fields.end(), [](const FieldDifference& field) {
    return field.name == "origin" || absl::StartsWith(field.name, "step in ");
  });
}

std::string ToJson(const Report& report) {
  const VoxelDifference& voxels = report.voxels;
  Json json = {{"equal", report.equal},   {"voxels", {{"a", report.voxels_a}, {"b", report.voxels_b}}},
               {"only_a", voxels.only_a}, {"only_b", voxels.only_b},
               {"both", voxels.both},     {"jaccard", voxels.Jaccard()},
               {"box", nullptr},          {"first", Json::array()},
               {"fields", Json::array()}};
  json["same_places"] = SamePlaces(report.fields);
  if (voxels.box) json["box"] = {{"min", voxels.box->min}, {"max", voxels.box->max}};
  for (const auto& [ijk, in_a] : voxels.first) json["first"].push_back({{"ijk", ijk}, {"only", in_a ? "a" : "b"}});
  for (const auto& [name, a, b] : report.fields) json["fields"].push_back({{"name", name}, {"a", a}, {"b", b}});
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ToText(const Report& report, const CompareWords& words) {
  const VoxelDifference& voxels = report.voxels;
  std::string text =
      absl::StrCat("A  ", words.a, ": ", report.voxels_a, " voxels\nB  ", words.b, ": ", report.voxels_b, " voxels\n");
  for (const auto& [name, a, b] : report.fields) {
    absl::StrAppend(&text, name, ": ", a.empty() ? "(none)" : a, " in A, ", b.empty() ? "(none)" : b, " in B\n");
  }
  if (!SamePlaces(report.fields))
    text += "the lattices differ: these are counts of coordinates, which are other places\n";
  absl::StrAppendFormat(&text, "%d voxels in both, %d in A alone, %d in B alone; Jaccard index %.6f\n", voxels.both,
                        voxels.only_a, voxels.only_b, voxels.Jaccard());
  if (voxels.box) {
    absl::StrAppend(&text, "they differ from ", absl::StrJoin(voxels.box->min, ","), " to below ",
                    absl::StrJoin(voxels.box->max, ","), "; first at\n");
  }
  for (const auto& [ijk, in_a] : voxels.first) {
    absl::StrAppend(&text, "  ", absl::StrJoin(ijk, ","), "  ", in_a ? "A" : "B", "\n");
  }
  return text + (report.equal ? "equal\n" : "different\n");
}

}  // namespace

void AddCompareOptions(CLI::App& command, CompareWords& words) {
  command.add_option("a", words.a, "a .vdb file")->type_name("A.vdb")->required();
  command.add_option("b", words.b, "another")->type_name("B.vdb")->required();
  command.add_flag("--voxels", words.voxels_only, "voxels and their places decide, whatever the metadata say");
  command.add_flag("--json", words.json, "machine-readable report on standard output");
  command.footer("Exit status: 0 equal, 1 different; others as of all commands\n");
}

absl::StatusOr<Comparison> RunCompare(const CompareWords& words) {
  const auto a = ReadGridFile(words.a);
  if (!a.ok()) return a.status();
  const auto b = ReadGridFile(words.b);
  if (!b.ok()) return b.status();
  Report report{false, a->info.active_voxels, b->info.active_voxels, CompareVoxels(a->bricks, b->bricks),
                CompareFields(a->info, b->info)};
  const bool same_fields = words.voxels_only ? a->info.transform == b->info.transform : report.fields.empty();
  report.equal = report.voxels.equal() && same_fields;
  return Comparison{report.equal, words.json ? ToJson(report) : ToText(report, words)};
}

}  // namespace latvox::client
