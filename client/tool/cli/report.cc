#include "client/tool/cli/report.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/json/json.h"
#include "client/json/warning_json.h"
#include "client/tool/cli/exit_status.h"
#include "client/tool/cli/walk_text.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

// Foreign text that is not UTF-8, such as a file name, must not break the report.
std::string Dump(const Json& json, int indent = 2) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string Count(uint64_t count, const char* what) { return absl::StrCat(count, " ", what, count == 1 ? "" : "s"); }

std::array<double, 9> Flat(const Basis& basis) {
  const auto& [a, b, c] = basis;
  return {a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]};
}

constexpr const char* kLeakKinds[] = {"enclosed", "in the surface", "leak", "box too large"};

Json LeakJson(const Leak& leak) {
  Json json = {{"kind", kLeakKinds[static_cast<size_t>(leak.kind)]}, {"from", leak.from}};
  if (leak.kind != Leak::Kind::kFound) return json;
  json["steps"] = leak.steps;
  json["narrowest"] = leak.narrowest;
  json["narrowest_world"] = leak.narrowest_world;
  json["room"] = leak.room;
  json["path"] = leak.path;
  return json;
}

// Volumes are in cubic world units.
//   cell   the volume of a voxel's cell
Json WalkJson(const WalkFacts& walk, double cell) {
  Json json = {
      {"cavities", walk.cavities}, {"largest_cavities", walk.largest_cavities}, {"largest_volumes", Json::array()}};
  for (const uint64_t points : walk.largest_cavities) {
    json["largest_volumes"].push_back(static_cast<double>(points) * cell);
  }
  if (walk.leak) json["leak"] = LeakJson(*walk.leak);
  for (const LabelWalk& of_label : walk.labels) {
    Json facts = {{"label", of_label.label},
                  {"cavities", of_label.cavities},
                  {"points", of_label.points},
                  {"volume", static_cast<double>(of_label.points) * cell}};
    if (of_label.leak) facts["leak"] = LeakJson(*of_label.leak);
    json["labels"].push_back(std::move(facts));
  }
  return json;
}

Json CertificateJson(const Certificate& certificate, double voxel_size) {
  Json json = {{"tunnels", certificate.verified ? Json(certificate.tunnels) : Json()},
               {"redundant", certificate.verified ? Json(certificate.redundant) : Json()},
               {"tunnel_free", certificate.tunnel_free},
               {"minimal", certificate.minimal},
               {"whole_minimal", certificate.whole_minimal},
               {"set", certificate.set},
               {"closed", certificate.closed},
               {"snap_error_max", certificate.snap_error_max},
               {"quantization_bits", certificate.quantization_bits},
               {"verified", certificate.verified},
               {"algorithm", certificate.algorithm},
               {"version", certificate.version}};
  if (const auto& solid = certificate.solid) {
    json["rule"] = solid->rule;
    json["unbalanced_lines"] = solid->unbalanced_lines;
  }
  if (!certificate.interior_rule.empty()) json["rule"] = certificate.interior_rule;
  if (certificate.walk) json["walk"] = WalkJson(*certificate.walk, std::pow(voxel_size, 3));
  return json;
}

// Each field with its digest, and with names of its numbers.
Json FieldsJson(const Certificate& certificate, const CarriedNames& names) {
  Json json = Json::object();
  for (const auto& [field, digest] : certificate.fields) {
    Json& of_field = json[NameOf(field)] = {{"digest", digest}};
    if (field == Field::kDistance) of_field["signed"] = certificate.signed_distance;
    if (FactsOf(field).is_of_cell()) of_field["n"] = certificate.fraction_n;
    if (FactsOf(field).is_of_labels()) of_field["labels"] = certificate.fraction_labels;
    if (!names.Of(field).empty()) of_field["names"] = names.Of(field);
  }
  return json;
}

Json LimitsJson(const Limits& limits) {
  Json libraries = Json::object();
  for (const auto& [name, version] : limits.libraries) libraries[name] = version;
  return {{"max_mesh_bytes", limits.max_mesh_bytes},
          {"max_triangles", limits.max_triangles},
          {"max_vertices", limits.max_vertices},
          {"max_extent", limits.max_extent},
          {"max_jobs", limits.max_jobs},
          {"max_message_bytes", limits.max_message_bytes},
          {"subvoxel_bits", limits.subvoxel_bits},
          {"max_points", limits.max_points},
          {"max_crossings", limits.max_crossings},
          {"max_pixels", limits.max_pixels},
          {"max_queued_jobs", limits.max_queued_jobs},
          {"max_jobs_per_client", limits.max_jobs_per_client},
          {"memory_budget_bytes", limits.memory_budget_bytes},
          {"mesh_store_bytes", limits.mesh_store_bytes},
          {"max_visited_points", limits.max_visited_points},
          {"max_job_seconds", limits.max_job_seconds},
          {"version", limits.version},
          {"commit", limits.commit},
          {"libraries", libraries}};
}

// Returns the certain facts about the set. Other algorithms than the exact one guarantee nothing beyond the counts.
std::string SeparationText(const Certificate& certificate) {
  if (const auto& band = certificate.band) return absl::StrFormat("band of %g", band->width);
  const std::string k = absl::StrCat(certificate.separability);
  if (certificate.set == "links") return absl::StrCat("ends of links, k = ", k);
  if (!certificate.tunnel_free && (certificate.walk || certificate.set == "interior")) return certificate.set;
  if (!certificate.tunnel_free) return absl::StrCat("k = ", k, ", ", certificate.algorithm);
  if (certificate.set == "supercover" || certificate.set == "supercover-solid") return "supercover";
  return absl::StrCat(k, "-separating", certificate.minimal ? ", minimal" : "");
}

std::string FillText(const Certificate& certificate) {
  const auto& solid = certificate.solid;
  if (!solid) {
    return certificate.interior_rule.empty() ? "" : absl::StrCat("inside by ", certificate.interior_rule, "\n");
  }
  std::string text =
      absl::StrCat("filled by ", solid->rule,
                   certificate.set == "interior" ? ", without the surface\n"
                                                 : ", with the surface, whose centers may lie outside\n");
  if (solid->unbalanced_lines > 0) {
    absl::StrAppend(&text, "not filled: ", solid->unbalanced_lines, " lattice lines along k that end unbalanced\n");
  }
  return text;
}

std::string FieldsText(const Certificate& certificate) {
  if (certificate.fields.empty()) return "";
  const auto name = [](std::string* out, const FieldCertificate& field) { *out += NameOf(field.field); };
  return absl::StrCat(
      "each voxel carries ", absl::StrJoin(certificate.fields, ", ", name),
      certificate.fraction_n != 0 ? absl::StrCat("; fractions are of ", certificate.fraction_n, "^3 points") : "",
      certificate.signed_distance ? "; distances are negative inside\n" : "\n");
}

std::string VerificationText(const Certificate& certificate) {
  if (!certificate.verified) return "";
  return absl::StrCat("verified: ", certificate.tunnels, " tunnels, ", certificate.redundant, " redundant voxels\n");
}

Json ErrorJson(const absl::Status& error) {
  const ErrorDetails details = GetErrorDetails(error);
  Json json = {{"code", absl::StatusCodeToString(error.code())},
               {"message", std::string(error.message())},
               {"exit_status", static_cast<int>(ExitStatusOf(error))}};
  for (const auto& [name, value] :
       {std::pair("field", details.field), {"value", details.value}, {"limit", details.limit}}) {
    if (!value.empty()) json[name] = value;
  }
  return json;
}

Json BoxJson(const std::optional<IndexBox>& box) { return box ? Json{{"min", box->min}, {"max", box->max}} : Json(); }

Json WeldJson(const WeldReport& weld) {
  return {{"vertices", weld.vertices},
          {"triangles", weld.triangles},
          {"duplicate_vertices", weld.duplicate_vertices},
          {"degenerate_triangles", weld.degenerate_triangles},
          {"open_edges", weld.open_edges},
          {"non_manifold_edges", weld.non_manifold_edges},
          {"inconsistent_edges", weld.inconsistent_edges}};
}

std::string WeldText(const WeldReport& weld) {
  return absl::StrCat("of ", weld.vertices, " vertices, ", weld.duplicate_vertices, " are duplicates; of ",
                      weld.triangles, " triangles, ", weld.degenerate_triangles,
                      " are degenerate; edges: ", weld.open_edges, " open, ", weld.non_manifold_edges,
                      " non-manifold, ", weld.inconsistent_edges, " between triangles of opposite orientation\n");
}

Json SummaryJson(const VoxelizeReport& report) {
  const Summary& summary = report.summary;
  const MeshFacts& mesh = report.accepted.mesh;
  Json json = {{"voxels", summary.voxels},
               {"bricks", summary.bricks},
               {"tiles", summary.tiles},
               {"lattice", summary.certificate.lattice},
               {"basis", Flat(report.accepted.grid.basis)},
               {"origin", report.accepted.grid.origin},
               {"voxel_size", report.accepted.grid.voxel_size},
               {"placement", NameOf(report.accepted.placement)},
               {"index_box", BoxJson(report.index_box)},
               {"separability", summary.certificate.separability},
               {"digest", summary.certificate.digest},
               {"certificate", CertificateJson(summary.certificate, report.accepted.grid.voxel_size)}};
  if (const auto& shard = summary.certificate.shard) json["shard"] = {{"index", shard->index}, {"count", shard->count}};
  if (const auto& band = summary.certificate.band) json["band"] = {{"width", band->width}};
  if (!summary.certificate.fields.empty()) json["fields"] = FieldsJson(summary.certificate, report.names);
  json["timings_ms"] = {{"read", report.read_ms},
                        {"encode", report.encode_ms},
                        {"upload", summary.timings.upload_ms},
                        {"decode", summary.timings.decode_ms},
                        {"voxelize", summary.timings.voxelize_ms},
                        {"stream", summary.timings.stream_ms},
                        {"total", report.total_ms}};
  json["bytes"] = {{"sent", summary.bytes_sent}, {"received", summary.bytes_received}};
  json["resumed"] = summary.resumed;
  if (report.dropped > 0) json["dropped"] = report.dropped;
  json["mesh"] = {{"triangles", mesh.triangles},
                  {"vertices", mesh.vertices},
                  {"degenerate_triangles", mesh.degenerate_triangles},
                  {"skipped_elements", report.skipped},
                  {"encoded_bytes", summary.mesh_bytes},
                  {"min", mesh.min},
                  {"max", mesh.max}};
  if (report.weld) json["mesh"]["weld_report"] = WeldJson(*report.weld);
  json["outputs"] = report.outputs;
  json["warnings"] = WarningsJson(summary.warnings);
  return json;
}

}  // namespace

std::string ToJson(const VoxelizeReport& report) { return Dump(SummaryJson(report)); }

std::string ToJsonLine(const JobResult& result) {
  using Outcome = JobResult::Outcome;
  constexpr const char* kNames[] = {"done", "failed", "skipped"};
  Json json = {{"id", result.id},
               {"line", result.line},
               {"status", kNames[static_cast<size_t>(result.outcome)]},
               {"ended_unix_ms", result.ended_unix_ms},
               {"mesh", result.mesh},
               {"outputs", result.outputs}};
  if (result.outcome != Outcome::kFailed) json["output_bytes"] = result.bytes;
  if (!result.job_digest.empty()) json["job_digest"] = result.job_digest;
  if (result.outcome == Outcome::kDone) json["summary"] = SummaryJson(result.report);
  if (result.outcome == Outcome::kFailed) json["error"] = ErrorJson(result.error);
  if (result.outcome == Outcome::kSkipped) json["digest"] = result.digest;
  return Dump(json, /*indent=*/-1);
}

std::string ToText(const VoxelizeReport& report) {
  const Certificate& certificate = report.summary.certificate;
  const MeshFacts& mesh = report.accepted.mesh;
  const std::string bits = certificate.quantization_bits == 0
                               ? "exact positions"
                               : absl::StrCat("positions of ", certificate.quantization_bits, " bits");
  std::string text = absl::StrCat(report.mesh_path, ": ", Count(mesh.triangles, "triangle"), ", ",
                                  mesh.closed ? "closed" : "not closed", ", ", bits, "\n");
  if (report.weld) text += WeldText(*report.weld);
  const char* const origin = report.is_fitted ? ", which fits --dims)" : ", the default)";
  const std::string resolution =
      report.default_resolution ? absl::StrCat(" (resolution ", *report.default_resolution, origin) : "";
  absl::StrAppendFormat(&text, "%s lattice, voxel size %.6g%s, %s, placement %s\n", certificate.lattice,
                        report.accepted.grid.voxel_size, resolution, SeparationText(certificate),
                        NameOf(report.accepted.placement));
  absl::StrAppend(&text, Count(report.summary.voxels, "voxel"), " in ", Count(report.summary.bricks, "brick"),
                  ", digest ", certificate.digest, "\n", FillText(certificate), WalkText(report),
                  FieldsText(certificate), VerificationText(certificate));
  if (report.dropped > 0) {
    absl::StrAppend(&text, Count(report.dropped, "voxel"),
                    " left out by the alpha cutoff: the others let paths through\n");
  }
  const std::string did = report.outputs.empty() ? "done" : absl::StrCat("wrote ", absl::StrJoin(report.outputs, ", "));
  absl::StrAppendFormat(&text, "%s in %.2f s\n", did, report.total_ms / 1e3);
  return text;
}

std::string ToJson(const BatchReport& report) {
  return Dump({{"jobs", report.jobs},
               {"done", report.done},
               {"failed", report.failed},
               {"skipped", report.skipped},
               {"exit_status", static_cast<int>(report.status)},
               {"total_ms", report.total_ms},
               {"results", report.results}});
}

std::string ToText(const BatchReport& report) {
  std::string text = absl::StrCat(report.done, " of ", report.jobs, " jobs done");
  if (report.skipped > 0) absl::StrAppend(&text, ", ", report.skipped, " skipped because they were done before");
  if (report.failed > 0) absl::StrAppend(&text, ", ", report.failed, " failed");
  absl::StrAppendFormat(&text, " in %.2f s; results in %s\n", report.total_ms / 1e3, report.results);
  return text;
}

std::string ToJson(const PixelizeReport& report) {
  const Pixelization& answer = report.answer;
  const auto& [a, b] = answer.grid.basis;
  Json json = {{"pixels", answer.pixels.size()},
               {"lattice", answer.lattice},
               {"basis", {a[0], a[1], b[0], b[1]}},
               {"origin", answer.grid.origin},
               {"pixel_size", answer.grid.pixel_size},
               {"separability", report.separability},
               {"digest", answer.digest},
               {"certificate",
                {{"tunnels", answer.tunnels},
                 {"redundant", answer.redundant},
                 {"crossed_edges", answer.crossed_edges},
                 {"snap_error_max", answer.snap_error_max},
                 {"algorithm", answer.algorithm},
                 {"version", answer.version}}}};
  json["timings_ms"] = {{"read", report.read_ms}, {"pixelize", answer.pixelize_ms}, {"total", report.total_ms}};
  json["bytes"] = {{"sent", answer.bytes_sent}, {"received", answer.bytes_received}};
  json["drawing"] = {{"polylines", report.polylines}, {"points", report.points}};
  json["outputs"] = report.outputs;
  return Dump(json);
}

std::string ToText(const PixelizeReport& report) {
  const Pixelization& answer = report.answer;
  std::string text = absl::StrCat(report.input_path, ": ", report.points, " points in ", report.polylines,
                                  report.polylines == 1 ? " polyline\n" : " polylines\n");
  absl::StrAppendFormat(&text, "%s lattice, pixel size %.6g, %d-separating, %s\n", answer.lattice,
                        answer.grid.pixel_size, report.separability, answer.algorithm);
  absl::StrAppend(&text, answer.pixels.size(), " pixels on ", answer.crossed_edges, " crossed edges: ", answer.tunnels,
                  " tunnels, ", answer.redundant, " redundant pixels\n");
  absl::StrAppendFormat(&text, "wrote %s in %.2f s\n", absl::StrJoin(report.outputs, ", "), report.total_ms / 1e3);
  return text;
}

std::string ToJson(const MergeReport& report) {
  const MergedGrid& merged = report.merged;
  Json json = {{"parts", report.parts},
               {"voxels", merged.voxels},
               {"bricks", merged.bricks},
               {"shared_bricks", merged.shared_bricks},
               {"digest", merged.digest}};
  json["timings_ms"] = {{"total", report.total_ms}};
  json["outputs"] = {report.output};
  return Dump(json);
}

std::string ToText(const MergeReport& report) {
  const MergedGrid& merged = report.merged;
  std::string text = absl::StrCat(report.parts, report.parts == 1 ? " part: " : " parts: ", merged.voxels,
                                  " voxels in ", merged.bricks, " bricks, digest ", merged.digest, "\n");
  absl::StrAppendFormat(&text, "wrote %s in %.2f s\n", report.output, report.total_ms / 1e3);
  return text;
}

std::string ToJson(const Limits& limits) { return Dump(LimitsJson(limits)); }

std::string ToText(const Limits& limits) {
  std::string text;
  Json json = LimitsJson(limits);
  json["libraries"] = absl::StrJoin(limits.libraries, ", ", [](std::string* list, const Library& library) {
    absl::StrAppend(list, library.name, " ", library.version);
  });
  for (const auto& [name, value] : json.items()) {
    const std::string shown = value.is_string() ? value.get<std::string>() : value.dump();
    absl::StrAppendFormat(&text, "%-20s %s\n", name, shown);
  }
  return text;
}

}  // namespace latvox::client
