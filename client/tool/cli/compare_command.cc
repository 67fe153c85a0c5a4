#include "client/tool/cli/compare_command.h"

#include <algorithm>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/grid/steps_text.h"
#include "client/json/json.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/difference_output.h"
#include "client/tool/cli/grid_input.h"
#include "client/tool/cli/value_difference.h"
#include "client/tool/cli/voxel_difference.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {
namespace {

struct Report {
  bool equal;
  uint64_t voxels_a, voxels_b;
  VoxelDifference voxels;
  std::vector<FieldDifference> fields;
  ValueDifference values;
};

// Returns whether equal coordinates are equal positions in both files.
bool SamePlaces(const std::vector<FieldDifference>& fields) {
  return std::none_of(fields.begin(), fields.end(), [](const FieldDifference& field) {
    return field.name == "origin" || absl::StartsWith(field.name, "step in ");
  });
}

std::string NamesOf(const std::vector<FieldValues>& fields) {
  return absl::StrJoin(fields, ",", [](std::string* out, const FieldValues& field) { *out += NameOf(field.field); });
}

// Compares the metadata, and which fields the voxels carry, whatever the metadata say about that.
std::vector<FieldDifference> FieldsOf(const GridContent& a, const GridContent& b) {
  std::vector<FieldDifference> fields = CompareFields(a.file.info, b.file.info);
  const std::string of_a = NamesOf(a.fields), of_b = NamesOf(b.fields);
  if (of_a != of_b) fields.push_back({"grids", of_a, of_b});
  if (!a.neighbors.empty() && !b.neighbors.empty() && a.neighbors != b.neighbors) {
    fields.push_back({"neighbors", StepsText(a.neighbors), StepsText(b.neighbors)});
  }
  return fields;
}

std::string ToJson(const Report& report, const std::vector<std::string>& outputs) {
  const VoxelDifference& voxels = report.voxels;
  Json json = {{"equal", report.equal},   {"voxels", {{"a", report.voxels_a}, {"b", report.voxels_b}}},
               {"only_a", voxels.only_a}, {"only_b", voxels.only_b},
               {"both", voxels.both},     {"jaccard", voxels.Jaccard()},
               {"box", nullptr},          {"first", Json::array()},
               {"fields", Json::array()}, {"distances", nullptr},
               {"links", nullptr},        {"values", Json::object()}};
  json["same_places"] = SamePlaces(report.fields);
  if (voxels.box) json["box"] = {{"min", voxels.box->min}, {"max", voxels.box->max}};
  for (const auto& [ijk, in_a] : voxels.first) json["first"].push_back({{"ijk", ijk}, {"only", in_a ? "a" : "b"}});
  for (const auto& [name, a, b] : report.fields) json["fields"].push_back({{"name", name}, {"a", a}, {"b", b}});
  if (const auto& distances = report.values.distances) {
    json["distances"] = {{"differ", distances->differ}, {"greatest", distances->greatest}, {"at", nullptr}};
    if (distances->at) json["distances"]["at"] = *distances->at;
  }
  if (const auto& links = report.values.links) {
    json["links"] = {{"crossed_in_one", links->crossed_in_one}, {"greatest", links->greatest}};
  }
  for (const auto& [field, differ] : report.values.others) json["values"][NameOf(field)] = differ;
  if (!outputs.empty()) json["outputs"] = outputs;
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string ToText(const Report& report, const CompareWords& words) {
  const VoxelDifference& voxels = report.voxels;
  std::string text =
      absl::StrCat("A  ", words.a, ": ", report.voxels_a, " voxels\nB  ", words.b, ": ", report.voxels_b, " voxels\n");
  for (const auto& [name, a, b] : report.fields) {
    absl::StrAppend(&text, name, ": ", a.empty() ? "(none)" : a, " in A, ", b.empty() ? "(none)" : b, " in B\n");
  }
  if (!SamePlaces(report.fields)) text += "the lattices differ: equal coordinates are different positions\n";
  absl::StrAppendFormat(&text, "%d voxels in both, %d in A alone, %d in B alone; Jaccard index %.6f\n", voxels.both,
                        voxels.only_a, voxels.only_b, voxels.Jaccard());
  if (voxels.box) {
    absl::StrAppend(&text, "they differ from ", absl::StrJoin(voxels.box->min, ","), " to below ",
                    absl::StrJoin(voxels.box->max, ","), "; first at\n");
  }
  for (const auto& [ijk, in_a] : voxels.first) {
    absl::StrAppend(&text, "  ", absl::StrJoin(ijk, ","), "  ", in_a ? "A" : "B", "\n");
  }
  if (const auto& distances = report.values.distances) {
    absl::StrAppend(&text, distances->differ, " of the distances in both differ");
    if (distances->at) {
      absl::StrAppendFormat(&text, ", by %g at most, at %s", distances->greatest, absl::StrJoin(*distances->at, ","));
    }
    text += "\n";
  }
  for (const auto& [field, differ] : report.values.others) {
    absl::StrAppend(&text, NameOf(field), ": ", differ, " of the voxels in both differ");
    if (field == Field::kLinks && differ > 0) {
      absl::StrAppendFormat(&text, "; links crossed in one file alone: %d; greatest difference of shares: %g",
                            report.values.links->crossed_in_one, report.values.links->greatest);
    }
    text += "\n";
  }
  const auto is_picture = [](const std::string& path) { return absl::EndsWithIgnoreCase(path, ".png"); };
  if (!words.outputs.empty()) {
    const bool any = std::any_of(words.outputs.begin(), words.outputs.end(), is_picture);
    absl::StrAppend(&text, "wrote ", absl::StrJoin(words.outputs, ", "), any ? ": " + DifferenceColorsText() : "",
                    "\n");
  }
  return text + (report.equal ? "equal\n" : "different\n");
}

absl::Status Write(const CompareWords& words, const GridContent& a, const GridContent& b, const Report& report,
                   const Cancellation& cancellation) {
  if (words.outputs.empty()) return absl::OkStatus();
  if (!SamePlaces(report.fields)) {
    return absl::InvalidArgumentError(absl::StrCat("--out: the lattices of ", words.a, " and ", words.b,
                                                   " differ: their difference has no place in one grid"));
  }
  const auto files = WriteDifferences(words, a, b, cancellation);
  if (!files.ok()) return files.status();
  if (cancellation.cancelled()) return absl::CancelledError("cancelled");
  for (const auto& file : *files) {
    if (auto status = file->Commit(); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace

void AddCompareOptions(CommandParser& command, CompareWords& words) {
  OptionRow output = OutputRow({".vdb", ".png"}, words.outputs, /*several=*/true);
  output.help = "Write the difference: a grid of the voxels that differ (.vdb), or a picture (.png); may be repeated";
  output.required = false;
  command.Add({GridFileRow(words.a, "a", "First OpenVDB or NanoVDB file", "A.vdb"),
               GridFileRow(words.b, "b", "Second OpenVDB or NanoVDB file", "B.vdb"),
               {.names = "--voxels",
                .target = &words.voxels_only,
                .help = "Compare only the voxels and their positions, neither fields nor metadata"},
               output,
               {.names = "--json", .target = &words.json, .help = "Print the report as JSON"}});
}

void Check(const CompareWords& words) {
  for (const std::string& input : {words.a, words.b}) CheckOutputs(words.outputs, input, "compared file");
}

absl::StatusOr<Comparison> RunCompare(const CompareWords& words, const Cancellation& cancellation) {
  const auto a = ReadInputContent(words.a, !words.voxels_only, cancellation);
  if (!a.ok()) return a.status();
  const auto b = ReadInputContent(words.b, !words.voxels_only, cancellation);
  if (!b.ok()) return b.status();
  const bool both_have_distances = a->distances && b->distances;
  if (a->is_band != b->is_band && !both_have_distances && !words.voxels_only) {
    return absl::InvalidArgumentError(absl::StrCat(a->is_band ? words.a : words.b, " is a band of distances, ",
                                                   a->is_band ? words.b : words.a,
                                                   " is a set of voxels; --voxels compares only the voxels"));
  }
  const GridFileInfo &of_a = a->file.info, &of_b = b->file.info;
  Report report{false,
                of_a.active_voxels,
                of_b.active_voxels,
                CompareVoxels(a->file.bricks, b->file.bricks),
                FieldsOf(*a, *b),
                words.voxels_only ? ValueDifference{} : CompareValues(*a, *b)};
  const bool same_fields = words.voxels_only ? of_a.transform == of_b.transform : report.fields.empty();
  report.equal = report.voxels.equal() && report.values.equal() && same_fields;
  if (auto status = Write(words, *a, *b, report, cancellation); !status.ok()) return status;
  return Comparison{report.equal, words.json ? ToJson(report, words.outputs) : ToText(report, words)};
}

}  // namespace latvox::client
