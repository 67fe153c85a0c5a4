#include "server/decode/decoder_protocol.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "server/base/errors.h"

namespace latvox {
namespace {

// Enough for each of our messages; a few of Draco's are a line long.
constexpr size_t kMaxErrorBytes = 1024;
constexpr uint32_t kMaxQuantizationBits = 31;

template <class T>
std::optional<T> As(absl::string_view frame) {
  if (frame.size() != sizeof(T)) return std::nullopt;
  T value;
  std::memcpy(&value, frame.data(), sizeof(T));
  return value;
}

// Appends the elements to `out`. Refuses a part of an element, and more elements than are missing to `total`.
template <class T, class Allocator>
bool Append(absl::string_view frame, size_t total, std::vector<T, Allocator>& out) {
  const size_t count = frame.size() / sizeof(T);
  if (frame.size() % sizeof(T) != 0 || count > total - out.size()) return false;
  const auto* first = reinterpret_cast<const T*>(frame.data());
  out.insert(out.end(), first, first + count);
  return true;
}

std::string Printable(absl::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (!absl::ascii_isprint(static_cast<unsigned char>(c))) c = '?';
  }
  return out;
}

}  // namespace

std::string EncodeError(const absl::Status& status) {
  const ErrorCause cause = CauseOf(status).value_or(ErrorCause{});
  std::string frame = absl::StrCat(static_cast<int>(status.code()), absl::string_view("\0", 1), status.message(),
                                   absl::string_view("\0", 1), cause.reason, absl::string_view("\0", 1), cause.field,
                                   absl::string_view("\0", 1), cause.value);
  absl::StrAppend(&frame, absl::string_view("\0", 1), cause.limit, absl::string_view("\0", 1));
  frame.resize(std::min((frame.size() + 3) / 4 * 4, kMaxErrorBytes));
  return frame;
}

absl::Status DecodeError(absl::string_view frame) {
  std::vector<std::string> parts;
  for (const absl::string_view part : absl::StrSplit(frame.substr(0, kMaxErrorBytes), '\0')) {
    parts.push_back(Printable(part));
  }
  parts.resize(std::max<size_t>(parts.size(), 6));
  // A process that was taken over must not choose the reason that metrics count.
  if (parts[2] != "LIMIT_EXCEEDED" && parts[2] != "OUT_OF_MEMORY") parts[2] = "BAD_MESH";
  const bool exhausted = parts[0] == absl::StrCat(static_cast<int>(absl::StatusCode::kResourceExhausted));
  return MakeError(exhausted ? absl::StatusCode::kResourceExhausted : absl::StatusCode::kInvalidArgument, parts[1],
                   {parts[2], parts[3], parts[4], parts[5]});
}

MeshReceiver::Progress MeshReceiver::Receive(FrameKind kind, absl::string_view frame) {
  switch (kind) {
    case FrameKind::kMesh:
      return ReceiveHead(frame);
    case FrameKind::kVertices:
      return ReceiveVertices(frame);
    case FrameKind::kTriangles:
      return ReceiveTriangles(frame);
    case FrameKind::kAttributes:
      return ReceiveAttributes(frame);
    case FrameKind::kDone: {
      const bool complete = head_ && frame.empty() && mesh_.mesh.vertices.size() == head_->vertices &&
                            mesh_.mesh.triangles.size() == head_->triangles &&
                            mesh_.mesh.attributes.size() == attributes();
      return complete ? Progress::kDone : Progress::kBroken;
    }
    case FrameKind::kError:
      error_ = DecodeError(frame);
      return Progress::kDone;
    case FrameKind::kReady:
    case FrameKind::kDeclaration:  // sets limits, and is no part of the mesh
      break;
  }
  return Progress::kBroken;
}

MeshReceiver::Progress MeshReceiver::ReceiveHead(absl::string_view frame) {
  const auto head = As<MeshFrame>(frame);
  if (head_ || !head || head->triangles == 0 || head->triangles > limits_.max_triangles ||
      head->vertices > limits_.max_vertices || head->quantization_bits > kMaxQuantizationBits) {
    return Progress::kBroken;
  }
  head_ = head;
  if (reserve_) error_ = reserve_(head->triangles, head->vertices);
  if (!error_.ok()) return Progress::kRefused;
  mesh_.quantization_bits = head->quantization_bits;
  // Takes addresses now, and memory as the elements come.
  mesh_.mesh.vertices.reserve(head->vertices);
  mesh_.mesh.triangles.reserve(head->triangles);
  mesh_.mesh.attributes.reserve(attributes());
  return Progress::kMore;
}

MeshReceiver::Progress MeshReceiver::ReceiveVertices(absl::string_view frame) {
  PaddedVector<Vec3f>& vertices = mesh_.mesh.vertices;
  const size_t before = vertices.size();
  if (!head_ || !Append(frame, head_->vertices, vertices)) return Progress::kBroken;
  bool finite = true;
  for (size_t v = before; v < vertices.size(); ++v) {
    for (const float x : vertices[v]) finite &= std::abs(x) <= std::numeric_limits<float>::max();
  }
  return finite ? Progress::kMore : Progress::kBroken;
}

MeshReceiver::Progress MeshReceiver::ReceiveTriangles(absl::string_view frame) {
  auto& triangles = mesh_.mesh.triangles;
  const size_t before = triangles.size();
  if (!head_ || !Append(frame, head_->triangles, triangles)) return Progress::kBroken;
  uint32_t last = 0;
  for (size_t t = before; t < triangles.size(); ++t) {
    for (const uint32_t v : triangles[t]) last = std::max(last, v);
  }
  return before == triangles.size() || last < head_->vertices ? Progress::kMore : Progress::kBroken;
}

MeshReceiver::Progress MeshReceiver::ReceiveAttributes(absl::string_view frame) {
  std::vector<uint32_t>& numbers = mesh_.mesh.attributes;
  const size_t before = numbers.size();
  if (!head_ || !Append(frame, attributes(), numbers)) return Progress::kBroken;
  const std::span<const Field> fields = wanted_.view();
  bool valid = true;
  for (size_t n = before; n < numbers.size(); ++n) valid &= numbers[n] <= FactsOf(fields[n % fields.size()]).largest;
  return valid ? Progress::kMore : Progress::kBroken;
}

absl::StatusOr<DecodedMesh> MeshReceiver::result() && {
  if (!error_.ok()) return error_;
  return std::move(mesh_);
}

}  // namespace latvox
