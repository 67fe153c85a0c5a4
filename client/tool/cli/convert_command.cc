#include "client/tool/cli/convert_command.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/field_list.h"
#include "client/tool/cli/grid_input.h"
#include "client/tool/output/file_metadata.h"
#include "client/tool/output/labels.h"
#include "client/tool/output/outputs.h"
#include "client/tool/view/page.h"
#include "latvox/grid/carried_names.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {
namespace {

constexpr const char* kCutOut[] = {"latvox_region", "latvox_bounds", "latvox_shard"};

// Errors: INVALID_ARGUMENT: the file lacks a field.
absl::Status CheckHas(const std::vector<Field>& fields, const std::string& path, const GridContent& content) {
  for (const Field field : fields) {
    if (FindField(content.fields, field) == nullptr) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": has no field ", NameOf(field)));
    }
  }
  return absl::OkStatus();
}

// Keeps these fields, in their order. Errors: those of CheckHas.
absl::Status Select(const std::vector<Field>& fields, const std::string& path, GridContent& content) {
  if (auto status = CheckHas(fields, path, content); !status.ok()) return status;
  std::vector<FieldValues> selected;
  for (const Field field : fields) selected.push_back(*FindField(content.fields, field));
  const auto is_of_links = [](const FieldValues& values) { return FactsOf(values.field).is_of_links(); };
  if (std::none_of(selected.begin(), selected.end(), is_of_links)) content.neighbors.clear();
  content.fields = std::move(selected);
  return absl::OkStatus();
}

// Returns the request as far as outputs ask for it.
VoxelizeRequest RequestOf(const GridContent& content, const std::vector<Field>& fields) {
  const GridFileInfo& info = content.file.info;
  VoxelizeRequest request;
  request.fields = fields;
  request.lattice = info.transform.basis;
  if (!content.distances || !HoldsBand(content)) return request;
  request.set = Band{.width = content.distances->most, .in_voxels = false};
  request.signed_distance = content.distances->is_signed;
  const auto is_cut = [&info](const char* name) { return !MetadatumOf(info, name).empty(); };
  const bool whole = content.is_band ? MetadatumOf(info, "class") == "level set"
                                     : std::none_of(std::begin(kCutOut), std::end(kCutOut), is_cut);
  if (!whole) request.region = info.active_box.value_or(IndexBox());  // its band has no inside: see DistanceGrid
  return request;
}

// Returns whether the metadatum is about the values of this field.
bool IsAboutValues(const FieldFacts& facts, absl::string_view name) {
  if (name == absl::StrCat("latvox_", facts.name, "_digest")) return true;
  if (facts.field == Field::kDistance) return name == "latvox_signed_distance";
  return facts.is_of_labels() && name == "latvox_fraction_labels";
}

// Returns the metadata about the mesh and the voxels with these fields. `all`: the file has no others.
MetadataPairs MetadataWith(const std::vector<Field>& fields, bool all, const GridFileInfo& info) {
  std::vector<Field> named = fields;
  if (CarriesField(fields, Field::kLabelFractions))
    named.push_back(FieldOfLabels(info));  // whose names its labels have
  const bool fractions = CarriesField(fields, Field::kFraction) || CarriesField(fields, Field::kLabelFractions);
  const auto is_left_out = [&](const std::string& name) {
    if (name == "latvox_fields") return fields.empty();
    if (name == "latvox_fraction_n") return !fractions;
    return std::any_of(kFields.begin(), kFields.end(), [&](const FieldFacts& facts) {
      if (name == absl::StrCat("latvox_", facts.name, "_names")) return !CarriesField(named, facts.field);
      return !CarriesField(fields, facts.field) && IsAboutValues(facts, name);
    });
  };
  MetadataPairs metadata;
  for (const auto& [name, text] : info.metadata) {
    if (!absl::StartsWith(name, "latvox_") || is_left_out(name)) continue;
    metadata.emplace_back(name, name == "latvox_fields" && !all ? JoinNames(fields) : text);
  }
  return metadata;
}

// Returns what the file tells about its voxels.
Summary SummaryOf(const GridFileInfo& info, uint64_t bricks) {
  Summary summary;
  summary.voxels = info.active_voxels;
  summary.bricks = bricks;
  summary.certificate.lattice = MetadatumOf(info, "latvox_lattice");
  summary.certificate.set = MetadatumOf(info, "latvox_set");
  summary.certificate.digest = MetadatumOf(info, "latvox_digest");
  summary.certificate.version = MetadatumOf(info, "latvox_version");
  if (!absl::SimpleAtoi(MetadatumOf(info, "latvox_separability"), &summary.certificate.separability)) {
    summary.certificate.separability = 0;
  }
  return summary;
}

}  // namespace

void AddConvertOptions(CommandParser& command, ConvertWords& words) {
  command.Add({GridFileRow(words.input),
               OutputRow(OutputExtensions(), words.outputs, /*several=*/true),
               {.names = "--fields",
                .target = &words.fields,
                .help = "Fields of the file to write, or none",
                .value = "NAME,...",
                .checks = {{CheckFieldList}},
                .standard = "all"}});
  command.Add(ShapeRows(words.shape));
}

ConvertOptions Interpret(const ConvertWords& words) {
  CheckOutputs(words.outputs, words.input, "file");
  ConvertOptions options = {words.input, words.outputs, std::nullopt, {}};
  if (!words.fields.empty()) options.fields = ParseFieldList(words.fields);
  InterpretShape(words.shape, words.outputs, options.output_options);
  CheckShape(words.shape, words.outputs, options.output_options, std::nullopt);
  if (options.fields) CheckArray(*options.fields, options.output_options);
  return options;
}

absl::StatusOr<VoxelFile> ReadVoxelFile(const std::string& path, const std::optional<std::vector<Field>>& fields,
                                        const Cancellation& cancellation) {
  auto content = ReadInputContent(path, /*values=*/true, cancellation);
  if (!content.ok()) return content.status();
  if (fields) {
    if (auto status = Select(*fields, path, *content); !status.ok()) return status;
  }
  VoxelFile file;
  std::vector<Field> kept;
  file.accepted.neighbors = content->neighbors;
  for (const FieldValues& values : content->fields) {
    kept.push_back(values.field);
    if (!values.labels.empty()) file.accepted.fraction_labels = values.labels;
  }
  const GridFileInfo& info = content->file.info;
  file.accepted.grid = info.transform;
  file.accepted.index_box = info.active_box;
  file.output_options.metadata = MetadataWith(kept, !fields, info);
  file.output_options.picture_up = UpOf(info);
  file.output_options.make_page = ViewPage;
  file.request = RequestOf(*content, kept);
  file.summary = SummaryOf(info, content->file.bricks.size());
  file.content = *std::move(content);
  return file;
}

absl::StatusOr<std::string> RunConvert(const ConvertOptions& options, const Cancellation& cancellation,
                                       std::vector<Warning>& warnings) {
  const auto file = ReadVoxelFile(options.input, options.fields, cancellation);
  if (!file.ok()) return file.status();
  OutputOptions output_options = file->output_options;
  output_options.dense_npy = options.output_options.dense_npy;
  output_options.array = options.output_options.array;
  output_options.shape = options.output_options.shape;
  output_options.cancellation = cancellation;
  if (const auto& array = output_options.array) {
    if (auto status = CheckHas(*array, options.input, file->content); !status.ok()) return status;
  }
  const GridFileInfo& info = file->content.file.info;
  Outputs outputs;
  for (const std::string& path : options.outputs) {
    auto output = OpenOutput(path, file->request, output_options);
    if (!output.ok()) return output.status();
    (*output)->SetNames(ReadCarriedNames(info));
    if (auto status = (*output)->Begin(file->accepted); !status.ok()) return status;
    outputs.push_back(*std::move(output));
  }
  const auto add = [&](const BrickBatch& batch) {
    return ForAllAtOnce(outputs, cancellation, [&](Output& output) { return output.Add(batch); });
  };
  if (auto status = AddInPieces(file->content.Batch(), cancellation, add); !status.ok()) return status;
  warnings = WarningsOf(outputs);
  const auto finish = [&](Output& output) { return output.Finish(file->summary); };
  if (auto status = ForAllAtOnce(outputs, cancellation, finish); !status.ok()) return status;
  if (cancellation.cancelled()) return absl::CancelledError("cancelled");
  if (auto status = CommitAll(outputs); !status.ok()) return status;
  const std::vector<Field>& fields = file->request.fields;
  return absl::StrCat(options.input, ": ", info.active_voxels, " voxels",
                      fields.empty() ? "" : absl::StrCat(" with ", JoinNames(fields)), "\nwrote ",
                      absl::StrJoin(options.outputs, ", "), "\n");
}

}  // namespace latvox::client
