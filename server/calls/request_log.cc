#include "server/calls/request_log.h"

#include <vector>

#include "server/base/errors.h"

namespace latvox {
namespace {

using Fields = std::vector<LogField>;

Fields OriginFields(const CallOrigin& origin) {
  Fields fields = {{"request_id", origin.request_id}, {"method", origin.method}, {"peer", origin.peer}};
  if (!origin.caller.name.empty()) fields.emplace_back("caller", origin.caller.name);
  if (origin.trace) {
    fields.emplace_back("trace_id", origin.trace->trace_id);
    fields.emplace_back("span_id", origin.trace->span_id);
    fields.emplace_back("parent_id", origin.trace->parent_id);
  }
  return fields;
}

void AppendCounts(std::monostate /*nothing*/, Fields& /*fields*/) {}
void AppendTimes(std::monostate /*nothing*/, Fields& /*fields*/) {}

void AppendCounts(const ComputationFacts& facts, Fields& fields) {
  fields.emplace_back("triangles", facts.triangles);
  fields.emplace_back("voxels", facts.voxels);
  fields.emplace_back("bricks", facts.bricks);
  fields.emplace_back("reserved_bytes", facts.reserved_bytes);
}

void AppendCounts(const PixelizationFacts& facts, Fields& fields) {
  fields.emplace_back("points", facts.points);
  fields.emplace_back("pixels", facts.pixels);
}

void AppendTimes(const ComputationFacts& facts, Fields& fields) {
  fields.emplace_back("decode_ms", facts.decode_ms);
  fields.emplace_back("voxelize_ms", facts.voxelize_ms);
  fields.emplace_back("stream_ms", facts.stream_ms);
  fields.emplace_back("estimated_ms", facts.estimated_ms);
  fields.emplace_back("cpu_ms", facts.cpu_ms);
}

void AppendTimes(const PixelizationFacts& facts, Fields& fields) {
  fields.emplace_back("pixelize_ms", facts.pixelize_ms);
}

}  // namespace

void LogRequest(const RequestRecord& record, LogLevel level) {
  Fields fields = OriginFields(record.origin);
  fields.emplace_back("code", absl::StatusCodeToString(CodeOnWire(record.status)));
  if (!record.lattice.empty()) {
    fields.emplace_back("lattice", record.lattice);
    fields.emplace_back("k", record.separability);
  }
  std::visit([&](const auto& facts) { AppendCounts(facts, fields); }, record.work);
  fields.emplace_back("bytes_in", record.bytes_in);
  fields.emplace_back("bytes_out", record.bytes_out);
  if (record.upload_ms) fields.emplace_back("upload_ms", *record.upload_ms);
  if (record.queue_ms) fields.emplace_back("queue_ms", *record.queue_ms);
  std::visit([&](const auto& facts) { AppendTimes(facts, fields); }, record.work);
  fields.emplace_back("total_ms", record.total_ms);
  if (!record.status.ok()) {
    fields.emplace_back("reason", ReasonOf(record.status));
    fields.emplace_back("error", record.status.message());
  }
  const bool ours = CodeOnWire(record.status) == absl::StatusCode::kInternal;
  Log(ours ? LogLevel::kError : level, "request", fields);
}

}  // namespace latvox
