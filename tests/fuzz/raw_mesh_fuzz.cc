// A foreign client's mesh as plain arrays. The check of arriving pieces and the reader agree, whatever the pieces.
#include <cstdint>
#include <cstdlib>

#include "absl/strings/string_view.h"
#include "server/decode/raw_mesh.h"

namespace {

using latvox::Field;

void Require(bool condition) {
  if (!condition) std::abort();
}

absl::Status CheckInPieces(absl::string_view bytes, const latvox::RawMeshLayout& layout, size_t size) {
  latvox::RawMeshCheck check(layout);
  for (size_t at = 0; at < bytes.size(); at += size) {
    if (absl::Status status = check.Add(bytes.substr(at, size)); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace

// Byte 0: the size of pieces; 1 and 2: numbers of vertices and triangles; 3: doubles, attributes. Then the arrays.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 4) return 0;
  latvox::RawMeshLayout layout{data[1], data[2], (data[3] & 1) != 0, {}};
  if ((data[3] & 2) != 0) layout.attributes.Add(Field::kColor);
  if ((data[3] & 4) != 0) layout.attributes.Add(Field::kPart);
  const absl::string_view bytes(reinterpret_cast<const char*>(data) + 4, size - 4);
  const absl::Status whole = CheckInPieces(bytes, layout, SIZE_MAX / 2);
  Require(CheckInPieces(bytes, layout, data[0] + size_t{1}) == whole);
  const auto mesh = latvox::ReadRawMesh(absl::Cord(bytes), layout, layout.attributes);
  const bool has_all = bytes.size() == layout.bytes() && layout.triangles > 0;
  Require(mesh.ok() == (has_all && whole.ok()));
  if (mesh.ok()) Require(mesh->vertex_count() == layout.vertices && CheckMesh(*mesh).ok());
  return 0;
}
